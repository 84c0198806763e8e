//! How pixels are drawn: how near, by what, and which of them.

use crate::hidden::Hidden;
use crate::plan::Method;
use crate::tolerance::Tolerance;

/// How a shadow is drawn on pixels.
#[derive(Debug, Clone, Copy, Default)]
pub struct PixelOptions<'a> {
    pub(crate) tolerance: Tolerance,
    pub(crate) method: Option<Method>,
    pub(crate) dither: bool,
    pub(crate) hidden: Option<&'a Hidden>,
}

impl<'a> PixelOptions<'a> {
    /// Every pixel within `tolerance` of the exact density before it is rounded to 8 bits, by the method that the plan chooses. The
    /// default is one level.
    #[must_use]
    pub fn new(tolerance: Tolerance) -> Self {
        Self {
            tolerance,
            ..Self::default()
        }
    }

    /// With one method, whatever the plan would choose, or none to leave it the choice. Where [`Method::Grid`] or
    /// [`Method::NinePatch`] cannot draw a shadow, it gives way to [`Method::Direct`]: what [`candidates`](crate::plan::candidates)
    /// are tells. Tilted casters and images have one way each, whatever the method.
    #[must_use]
    pub fn with_method(mut self, method: impl Into<Option<Method>>) -> Self {
        self.method = method.into();
        self
    }

    /// With or without an ordered pattern that spreads the last rounding to 8 bits, so that a wide and faint penumbra shows no
    /// bands: then it is wrong by up to one of its steps rather than half.
    #[must_use]
    pub fn with_dither(mut self, dither: bool) -> Self {
        self.dither = dither;
        self
    }

    /// Without the pixels that are hidden, which need not be drawn, or with all of them. They are to be those of the grid that is
    /// drawn on.
    #[must_use]
    pub fn with_hidden(mut self, hidden: impl Into<Option<&'a Hidden>>) -> Self {
        self.hidden = hidden.into();
        self
    }
}

impl From<Tolerance> for PixelOptions<'_> {
    fn from(tolerance: Tolerance) -> Self {
        Self::new(tolerance)
    }
}
