//! Triangles with a density at each vertex, interpolated by a GPU into one channel of 8 bits.

use anyhow::{Context, Result};
use penumbral::{MeshBuffers, MeshVertex};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// A device with a pipeline and a texture to draw into.
pub(crate) struct Gpu {
    name: String,
    size: [u32; 2],
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::RenderPipeline,
    target: wgpu::Texture,
}

const SHADER: &str = "
struct Vertex { @location(0) position: vec2<f32>, @location(1) density: f32 }
struct Fragment { @builtin(position) position: vec4<f32>, @location(0) density: f32 }
override width: f32;
override height: f32;

@vertex fn vertex(v: Vertex) -> Fragment {
    let place = v.position / vec2(width, height) * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    return Fragment(vec4(place, 0.0, 1.0), v.density);
}

@fragment fn fragment(f: Fragment) -> @location(0) vec4<f32> {
    return vec4(f.density, 0.0, 0.0, 1.0);
}
";

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

impl Gpu {
    pub(crate) fn new(size: [u32; 2]) -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter =
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
                .context("no Vulkan device: Debian's mesa-vulkan-drivers has one in software")?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self {
            name: adapter.get_info().name,
            size,
            pipeline: pipeline(&device, size),
            device,
            queue,
            target,
        })
    }

    /// The device's name.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The densities of a mesh, 0 where there is none.
    pub(crate) fn draw(&self, mesh: &MeshBuffers<u32>) -> Result<Vec<u8>> {
        let buffer = |contents: &[u8], usage| {
            self.device.create_buffer_init(&BufferInitDescriptor {
                label: None,
                contents,
                usage,
            })
        };
        let number = |&MeshVertex {
                          position: [x, y],
                          density,
                      }: &MeshVertex| [x, y, density];
        let vertices: Vec<[f32; 3]> = mesh.vertices.iter().map(number).collect();
        let vertices = buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX);
        let indices = buffer(
            bytemuck::cast_slice(&mesh.indices),
            wgpu::BufferUsages::INDEX,
        );
        // Rows of a copy are whole numbers of 256 bytes.
        let stride = self.size[0].next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(stride) * u64::from(self.size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let view = self.target.create_view(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.indices.len() as u32, 0, 0..1);
        }
        encoder.copy_texture_to_buffer(
            self.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride),
                    rows_per_image: None,
                },
            },
            extent(self.size),
        );
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        copy.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody waits any more where the receiver is gone.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        receiver.recv()??;
        let rows = copy.get_mapped_range(..);
        let rows = rows.chunks_exact(stride as usize);
        Ok(rows
            .flat_map(|row| &row[..self.size[0] as usize])
            .copied()
            .collect())
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}

fn pipeline(device: &wgpu::Device, size: [u32; 2]) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let [width, height] = size.map(f64::from);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("width", width), ("height", height)],
                ..Default::default()
            },
            buffers: &[wgpu::VertexBufferLayout {
                array_stride: size_of::<MeshVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32],
            }],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
