//! `mesh`: the shadow of each surface on the ground as triangles.

use std::path::Path;

use penumbral::{Light, MeshOptions, ShadowMesh, Surface, meshes_to_svg};
use serde_json::json;

use crate::{Failure, extension, output, read_scene};

/// The mesh of a surface's shadow under a light, by the surface's field in the file and the light's number.
struct Made<'a> {
    surface: &'a Surface,
    field: &'a str,
    light: usize,
    mesh: ShadowMesh,
}

pub(crate) fn run(path: &Path, file: &Path, options: MeshOptions) -> Result<(), Failure> {
    let kind = extension(file, &["svg", "json", "obj"])?;
    let scene = read_scene(path)?;
    let lights: Vec<Light> = scene.lights().map(|(light, _)| light).collect();
    let bar = output::progress(lights.len() * scene.surfaces().len(), "meshes");
    let mut made = Vec::with_capacity(lights.len() * scene.surfaces().len());
    let surfaces = || scene.surfaces().iter().zip(scene.surface_fields());
    for (surface, field) in surfaces().filter(|(surface, _)| surface.casts()) {
        for (number, light) in lights.iter().enumerate() {
            if let Some(mesh) = mesh(light, surface, options)? {
                made.push(Made {
                    surface,
                    field,
                    light: number,
                    mesh,
                });
            }
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let text = match kind {
        "json" => json_text(&made),
        "obj" => {
            let mut first = 0;
            let mut text = String::new();
            for made in &made {
                let name = made.surface.name().unwrap_or(made.field);
                let name = match made.light {
                    0 => name.to_owned(),
                    light => format!("{name}.light{light}"),
                };
                text.push_str(&made.mesh.to_obj(&name, first));
                first += made.mesh.vertices().len();
            }
            text
        }
        _ => meshes_to_svg(made.iter().map(|made| &made.mesh), scene.scale())
            .map_err(|error| error.to_string())?,
    };
    output::write(file, text.as_bytes())?;
    for (surface, field) in surfaces() {
        if surface.as_image().is_some() && surface.casts() {
            output::complain(&format!(
                "{field}: the shadow of an image has no triangles: it is left out"
            ));
        }
    }
    for made in &made {
        if let Some(reason) = made.mesh.incomplete() {
            output::complain(&format!(
                "{}: the mesh is not complete: {reason}; it is up to {:.2} levels wrong",
                made.field,
                made.mesh.error_levels().min(255.0)
            ));
        }
    }
    Ok(())
}

/// The mesh of a surface's shadow on the ground; an image's has none.
fn mesh(
    light: &Light,
    surface: &Surface,
    options: MeshOptions,
) -> Result<Option<ShadowMesh>, Failure> {
    if surface.as_image().is_some() {
        return Ok(None);
    }
    let shape = surface.shape();
    let mesh = match surface.pose() {
        Some(pose) => light
            .cast_posed(shape, pose, 0.0)
            .map(|shadow| shadow.mesh(options)),
        None => light
            .cast(shape, surface.elevation(), 0.0)
            .map(|shadow| shadow.mesh(options)),
    };
    Ok(Some(mesh.map_err(|error| error.to_string())?))
}

fn json_text(made: &[Made<'_>]) -> String {
    let shadows: Vec<_> = made
        .iter()
        .map(|made| {
            let vertices = made.mesh.vertices();
            json!({
                "surface": made.field,
                "light": made.light,
                "positions": vertices.iter().map(|vertex| vertex.position).collect::<Vec<_>>(),
                "densities": vertices.iter().map(|vertex| vertex.density).collect::<Vec<_>>(),
                "indices": made.mesh.indices(),
                "error_levels": made.mesh.error_levels(),
            })
        })
        .collect();
    json!({ "shadows": shadows }).to_string()
}
