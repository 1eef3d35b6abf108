//! The mathematics of Sunshine, written once for both devices.
//!
//! Every file holds one module named `kernel` that the attribute `#[wgsl]` turns into WGSL; the same functions
//! run natively on the CPU. The kernels know neither files nor buffers nor threads: they read the scene through
//! the trait [`records::kernel::SceneAccess`], which each device implements over its own memory.
//!
//! Rules that keep the two languages in step: parameters are values and new state is returned; loops that
//! depend on data are marked; no kernel relies on infinities or NaN, which WGSL does not guarantee.
// WGSL has no std::f32::consts, and no method calls such as (a..b).contains(&x).
#![allow(clippy::approx_constant, clippy::excessive_precision, clippy::manual_range_contains)]
// The translator knows no assignments with bitwise operators.
#![allow(clippy::assign_op_pattern)]

pub mod bsdf;
pub mod bump;
pub mod bvh;
pub mod camera;
pub mod channel;
pub mod coordinates;
pub mod hit;
pub mod illumination;
pub mod layers;
pub mod light;
pub mod light_tree;
pub mod medium;
pub mod mesh;
pub mod noise;
pub mod path;
pub mod pixel;
pub mod random;
pub mod raytrace;
pub mod reconstruction;
pub mod records;
pub mod shading;
pub mod shape;
pub mod sky;
pub mod sobol;
pub mod sums;
pub mod texture;
pub mod tone;
pub mod traversal;
pub mod volume;
pub mod warp;
