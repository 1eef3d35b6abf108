//! The experiments of T. Huwe, "Stochastischer GPU-Strahlenverfolger für GroIMP" (2008), on today's machines.
//!
//! The scenes are built anew from what the thesis says about them, with fixed seeds; pictures and times stand beside
//! the figures of the thesis. Larger scenes of the same kind show how today's renderers grow with their number of objects.

mod bush;
mod experiments;
mod large;
mod measure;
mod pictures;
mod plot;
mod reference;
mod scenes;
mod table;

pub use experiments::{Experiment, Outcome, all};
pub use large::{BUILT_IN, BuiltIn};
pub use measure::{ExperimentError, Machine, Scale};
pub use pictures::{Picture, pictures};
pub use plot::{Plot, PlotError};
pub use scenes::{ThesisScene, scene};
pub use table::{Table, seconds};
