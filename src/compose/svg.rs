//! A scene as an SVG picture.
//!
//! Each surface is a group with its own coverage as mask: a fill, and the shadows on its elevation, which all surfaces of
//! that elevation share. The shadows of the light are drawn as densities in one group whose opacity is the tone's strength,
//! so that umbrae over umbrae get no darker than one.

use std::borrow::Cow;

use glam::DVec2;

use super::caster::{AnyShadow, Cast};
use super::{Receiver, Stage};
use crate::density::averaged_side;
use crate::error::{Error, Result};
use crate::scene::{Form, Scene, Surface};
use crate::shadow::Shadow;
use crate::svg::{Svg, number};
use crate::tolerance::Tolerance;
use crate::tone::Blending;

impl Scene {
    /// The scene as an SVG picture of the same size and the same look as the PNG: each shadow within `tolerance` of the
    /// exact one, where it is wide against a pixel, and the rounding of what shows it. Coordinates have fixed decimals and
    /// everything has its place, so that the text can be a snapshot.
    ///
    /// Casters of several elevations are taken as independent of each other here, and below 3 pixels of penumbra radius tilted
    /// ones are seen at the pixels' centres.
    ///
    /// # Errors
    /// [`Error::NotInSvg`] for images, finishes, linear blending, and tilted casters that reach the light's plane.
    pub fn to_svg(&self, tolerance: Tolerance) -> Result<String> {
        let has = |is: fn(&Form) -> bool| self.surfaces().iter().any(|surface| is(surface.form()));
        let missing = [
            ("an image", has(|form| matches!(form, Form::Image(..)))),
            #[cfg(feature = "finish")]
            (
                "a finish",
                self.surfaces()
                    .iter()
                    .any(|surface| surface.finish().is_some()),
            ),
            (
                "linear blending",
                self.tone().blending() == Blending::Linear,
            ),
        ];
        if let Some((what, _)) = missing.into_iter().find(|(_, is_there)| *is_there) {
            return Err(Error::NotInSvg { what });
        }
        let grid = self.grid()?;
        let size = [grid.width(), grid.height()].map(f64::from);
        let extent = DVec2::from(size) / grid.pixels_per_unit();
        let stage = Stage::new(self)?;
        let mut writer = Writer {
            scene: self,
            stage: &stage,
            tolerance,
            svg: Svg::new(grid.pixels_per_unit()),
            levels: Vec::new(),
        };
        let whole = writer.svg.rectangle(DVec2::ZERO, extent);
        writer
            .svg
            .draw(&format!("<rect {whole} fill=\"{}\"/>", self.background()));
        if let Some(level) = writer.level(&Receiver::ground(self))? {
            writer.svg.draw(&format!("<use href=\"#s{level}\"/>"));
        }
        for (rank, &surface) in stage.order.iter().enumerate() {
            if let Some(receiver) =
                Receiver::surface(self, surface).filter(|_| surface.weight() > 0.0)
            {
                writer.draw_surface(surface, &receiver, rank)?;
            }
        }
        Ok(writer.svg.finish(size, DVec2::ZERO, extent))
    }
}

struct Writer<'a> {
    scene: &'a Scene,
    stage: &'a Stage<'a>,
    tolerance: Tolerance,
    svg: Svg,
    /// The elevations whose shadows are defined, and whether there are any.
    levels: Vec<(f32, bool)>,
}

impl Writer<'_> {
    fn draw_surface(&mut self, surface: &Surface, receiver: &Receiver, rank: usize) -> Result<()> {
        // A tenth of a level of coverage.
        let pixel = 1.0 / f64::from(self.scene.scale());
        let data = self
            .svg
            .path_data(&surface.cover().polygons_within(0.1, pixel));
        // Its alpha is part of the weight.
        let fill = surface.fill().opaque();
        let weight = number(f64::from(surface.weight()), 4);
        let level = if surface.receives() && self.stage.is_shaded(receiver)? {
            self.level(receiver)?
        } else {
            None
        };
        let Some(level) = level else {
            self.svg.draw(&format!(
                "<path fill=\"{fill}\" fill-opacity=\"{weight}\" d=\"{data}\"/>"
            ));
            return Ok(());
        };
        let size = receiver.max - receiver.min + 2.0;
        let around = self.svg.rectangle(receiver.min - 1.0, size);
        self.svg.define(&format!(
            "<mask id=\"m{rank}\" maskUnits=\"userSpaceOnUse\" {around}>\
             <path fill=\"#fff\" fill-opacity=\"{weight}\" d=\"{data}\"/></mask>",
        ));
        self.svg.draw(&format!(
            "<g mask=\"url(#m{rank})\"><rect {around} fill=\"{fill}\"/><use href=\"#s{level}\"/></g>"
        ));
        Ok(())
    }

    /// The number of the group of all shadows on a receiver's elevation, defined when it is first asked for, or none
    /// where no shadow falls on the canvas. Receivers of one elevation share it.
    fn level(&mut self, receiver: &Receiver) -> Result<Option<usize>> {
        let known = self
            .levels
            .iter()
            .position(|(elevation, _)| *elevation == receiver.elevation);
        if let Some(level) = known {
            return Ok(Some(level).filter(|&level| self.levels[level].1));
        }
        let receiver = Receiver {
            elevation: receiver.elevation,
            ..Receiver::ground(self.scene)
        };
        let casts = self.stage.casts(&receiver)?;
        let level = self.levels.len();
        let any = !casts.is_empty();
        self.levels.push((receiver.elevation, any));
        if !any {
            return Ok(None);
        }
        let mut group = self.svg.part();
        group.draw(&format!("<g id=\"s{level}\">"));
        for (strength, casts) in &casts {
            self.draw_casts(casts, f64::from(*strength), &mut group)?;
        }
        group.draw("</g>");
        self.svg.define_part(group);
        Ok(Some(level))
    }

    fn draw_casts(&self, casts: &[Cast], strength: f64, svg: &mut Svg) -> Result<()> {
        svg.draw(&format!("<g opacity=\"{}\">", number(strength, 4)));
        for cast in casts {
            // What a faint shadow may be wrong by, the picture is wrong by less.
            let tolerance = self.tolerance.divided(strength * cast.weight());
            let mesh = match &cast.shadow {
                AnyShadow::Level(shadow) => self.averaged(shadow).mesh(tolerance),
                AnyShadow::Tilted(shadow) => shadow.mesh(tolerance),
                // Refused before.
                AnyShadow::Alpha(_) => continue,
            };
            if mesh.indices().is_empty() && !mesh.is_complete() {
                return Err(Error::NotInSvg {
                    what: "a shadow without end",
                });
            }
            svg.draw("<g shape-rendering=\"crispEdges\">");
            svg.draw_mesh(&mesh, cast.weight(), self.scene.tone().color());
            svg.draw("</g>");
        }
        svg.draw("</g>");
        Ok(())
    }

    /// Triangles give a pixel the density at its centre, where the picture has an average over a square: the shadow whose
    /// disc has the variance of disc and square together. (A disc of radius r has the variance r²/4 along each axis, a
    /// square of side b has b²/12.) At a straight hard edge it is within 8 levels of the average, 1.5 levels of the picture
    /// at Android's strength; from 3 pixels on it is the shadow itself.
    fn averaged<'s>(&self, shadow: &'s Shadow) -> Cow<'s, Shadow> {
        let scale = f64::from(self.scene.scale());
        let radius = shadow.radius() * scale;
        let side = averaged_side(radius);
        if side == 0.0 {
            return Cow::Borrowed(shadow);
        }
        Cow::Owned(shadow.with_radius((radius * radius + side * side / 3.0).sqrt() / scale))
    }
}
