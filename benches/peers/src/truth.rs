//! The exact densities of a scene, and how far a drawing is from them.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use anyhow::{Result, ensure};

/// A map of densities, row by row, 0 to 1.
pub(crate) struct Truth {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) densities: Vec<f32>,
}

/// Errors over a whole canvas, in levels: 1/255 of density.
#[derive(Clone, Copy)]
pub(crate) struct Errors {
    pub(crate) max: f64,
    pub(crate) rms: f64,
}

impl Truth {
    /// Reads 16-bit grey, white = 1.
    pub(crate) fn read(png: &Path) -> Result<Self> {
        let mut reader = png::Decoder::new(BufReader::new(File::open(png)?)).read_info()?;
        let info = reader.info();
        let (width, height) = (info.width, info.height);
        ensure!(
            (info.color_type, info.bit_depth)
                == (png::ColorType::Grayscale, png::BitDepth::Sixteen),
            "{} is not 16-bit grey",
            png.display()
        );
        let mut bytes = vec![0; width as usize * height as usize * 2];
        reader.next_frame(&mut bytes)?;
        let density = |pair: &[u8; 2]| f32::from(u16::from_be_bytes(*pair)) / 65535.0;
        let densities = bytes.as_chunks().0.iter().map(density).collect();
        Ok(Self {
            width,
            height,
            densities,
        })
    }

    /// The errors of shadows drawn in black on a white canvas.
    pub(crate) fn errors(&self, canvas: &[u8]) -> Errors {
        let (mut max, mut sum) = (0.0_f64, 0.0);
        for (pixel, truth) in canvas.as_chunks::<4>().0.iter().zip(&self.densities) {
            let levels = f64::from(255 - pixel[0]) - f64::from(*truth) * 255.0;
            max = max.max(levels.abs());
            sum += levels * levels;
        }
        Errors {
            max,
            rms: (sum / self.densities.len() as f64).sqrt(),
        }
    }
}
