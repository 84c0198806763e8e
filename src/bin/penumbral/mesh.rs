//! `mesh`: the shadow of each surface on the ground as triangles.

use std::path::Path;

use penumbral::{Light, MeshOptions, ShadowMesh, Surface, meshes_to_svg};
use serde_json::json;

use crate::{Failure, extension, output, read_scene};

/// The mesh of a surface's shadow under a light, by their numbers in the scene.
struct Made {
    surface: usize,
    light: usize,
    mesh: ShadowMesh,
}

pub(crate) fn run(path: &Path, file: &Path, options: MeshOptions) -> Result<(), Failure> {
    let kind = extension(file, &["svg", "json", "obj"])?;
    let scene = read_scene(path)?;
    let lights: Vec<Light> = scene.lights().map(|(light, _)| light).collect();
    let bar = output::progress(lights.len() * scene.surfaces().len(), "meshes");
    let mut made = Vec::with_capacity(lights.len() * scene.surfaces().len());
    for (surface, casting) in scene.surfaces().iter().enumerate() {
        for (number, light) in lights.iter().enumerate() {
            if let Some(mesh) = mesh(light, casting, options)? {
                made.push(Made {
                    surface,
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
            for Made {
                surface,
                light,
                mesh,
            } in &made
            {
                let name = scene.surfaces()[*surface].name();
                let name = name.map_or_else(|| format!("surface{surface}"), str::to_owned);
                let name = match light {
                    0 => name,
                    _ => format!("{name}.light{light}"),
                };
                text.push_str(&mesh.to_obj(&name, first));
                first += mesh.vertices().len();
            }
            text
        }
        _ => meshes_to_svg(made.iter().map(|made| &made.mesh)),
    };
    output::write(file, text.as_bytes())?;
    for (index, surface) in scene.surfaces().iter().enumerate() {
        if surface.as_image().is_some() {
            output::complain(&format!(
                "surfaces[{index}]: the shadow of an image has no triangles: it is left out"
            ));
        }
    }
    for Made { surface, mesh, .. } in made.iter().filter(|made| !made.mesh.is_complete()) {
        output::complain(&format!(
            "surfaces[{surface}]: the mesh is not complete: it is up to {:.2} levels wrong",
            mesh.error_levels().min(255.0)
        ));
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

fn json_text(made: &[Made]) -> String {
    let shadows: Vec<_> = made
        .iter()
        .map(
            |Made {
                 surface,
                 light,
                 mesh,
             }| {
                let vertices = mesh.vertices();
                json!({
                    "surface": surface,
                    "light": light,
                    "positions": vertices.iter().map(|vertex| vertex.position).collect::<Vec<_>>(),
                    "densities": vertices.iter().map(|vertex| vertex.density).collect::<Vec<_>>(),
                    "indices": mesh.indices(),
                    "error_levels": mesh.error_levels(),
                })
            },
        )
        .collect();
    json!({ "shadows": shadows }).to_string()
}
