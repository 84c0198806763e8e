//! `mesh`: the shadow of each surface on the ground as triangles.

use std::path::Path;

use penumbral::{MeshOptions, ShadowMesh, meshes_to_svg};
use serde_json::json;

use crate::{Failure, extension, output, read_scene};

pub(crate) fn run(path: &Path, file: &Path, options: MeshOptions) -> Result<(), Failure> {
    let kind = extension(file, &["svg", "json", "obj"])?;
    let scene = read_scene(path)?;
    let bar = output::progress(scene.surfaces().len(), "meshes");
    let mut meshes = Vec::with_capacity(scene.surfaces().len());
    for surface in scene.surfaces() {
        let shadow = scene
            .light()
            .cast(surface.shape(), surface.elevation(), 0.0);
        meshes.push(shadow.map_err(|error| error.to_string())?.mesh(options));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let text = match kind {
        "json" => json_text(&meshes),
        "obj" => {
            let mut first = 0;
            let mut text = String::new();
            for (index, (mesh, surface)) in meshes.iter().zip(scene.surfaces()).enumerate() {
                let name = surface
                    .name()
                    .map_or_else(|| format!("surface{index}"), str::to_owned);
                text.push_str(&mesh.to_obj(&name, first));
                first += mesh.vertices().len();
            }
            text
        }
        _ => meshes_to_svg(&meshes),
    };
    output::write(file, text.as_bytes())?;
    for (index, mesh) in meshes
        .iter()
        .enumerate()
        .filter(|(_, mesh)| !mesh.is_complete())
    {
        output::complain(&format!(
            "surfaces[{index}]: the mesh is not complete: it is up to {:.2} levels wrong",
            mesh.error_levels()
        ));
    }
    Ok(())
}

fn json_text(meshes: &[ShadowMesh]) -> String {
    let shadows: Vec<_> = meshes
        .iter()
        .map(|mesh| {
            let vertices = mesh.vertices();
            json!({
                "positions": vertices.iter().map(|vertex| vertex.position).collect::<Vec<_>>(),
                "densities": vertices.iter().map(|vertex| vertex.density).collect::<Vec<_>>(),
                "indices": mesh.indices(),
                "error_levels": mesh.error_levels(),
            })
        })
        .collect();
    json!({ "shadows": shadows }).to_string()
}
