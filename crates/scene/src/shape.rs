use crate::{MeshId, VisibleSides};
use glam::DVec3;

/// Geometry in object space, with GroIMP's local frames: z is the axis of everything that has one.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Centred on the origin.
    Sphere {
        /// In metres, positive.
        radius: f64,
    },
    /// x in ±width/2, y in ±height/2, z in 0..length.
    Box {
        /// Extent along x.
        width: f64,
        /// Extent along y.
        height: f64,
        /// Extent along z.
        length: f64,
    },
    /// Round tube along z from 0 to `length`.
    Cylinder {
        /// In metres, positive.
        radius: f64,
        /// Extent along z.
        length: f64,
        /// No cap at z = 0.
        base_open: bool,
        /// No cap at z = length.
        top_open: bool,
        /// v runs to `length` instead of 1.
        scale_v: bool,
    },
    /// Base circle at z = 0, apex at z = length.
    Cone {
        /// Radius of the base in metres, positive.
        radius: f64,
        /// Extent along z.
        length: f64,
        /// No cap at z = 0.
        open: bool,
        /// v runs to `length` instead of 1.
        scale_v: bool,
    },
    /// Cone cut off parallel to its base; the radius changes linearly along z.
    Frustum {
        /// Radius at z = 0 in metres, not negative.
        base_radius: f64,
        /// Radius at z = length in metres, not negative.
        top_radius: f64,
        /// Extent along z.
        length: f64,
        /// No cap at z = 0.
        base_open: bool,
        /// No cap at z = length.
        top_open: bool,
        /// v runs to `length` instead of 1.
        scale_v: bool,
    },
    /// The infinite plane z = 0, front side +z.
    Plane,
    /// Corners -axis, +axis, axis + (0,0,length), -axis + (0,0,length); front side z × axis.
    Parallelogram {
        /// Extent along z.
        length: f64,
        /// Half of the base edge.
        axis: DVec3,
        /// v runs to `length` instead of 1.
        scale_v: bool,
    },
    /// Triangles.
    Mesh {
        /// The triangles, which several objects may share.
        mesh: MeshId,
        /// From where they can be seen; rays that come from elsewhere pass.
        visible_sides: VisibleSides,
    },
}

impl Shape {
    /// What users and statistics call it: GroIMP's class name.
    pub fn name(&self) -> &'static str {
        match self {
            Shape::Sphere { .. } => "Sphere",
            Shape::Box { .. } => "Box",
            Shape::Cylinder { .. } => "Cylinder",
            Shape::Cone { .. } => "Cone",
            Shape::Frustum { .. } => "Frustum",
            Shape::Plane => "Plane",
            Shape::Parallelogram { .. } => "Parallelogram",
            Shape::Mesh { .. } => "Mesh",
        }
    }

    /// Bounding box in object space as (minimum, maximum); `None` for the infinite plane and for meshes, whose
    /// vertices are elsewhere (see [`Mesh::bounds`](crate::Mesh::bounds)).
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let round = |radius: f64, length: f64| {
            Some((DVec3::new(-radius, -radius, length.min(0.0)), DVec3::new(radius, radius, length.max(0.0))))
        };
        match *self {
            Shape::Sphere { radius } => Some((DVec3::splat(-radius), DVec3::splat(radius))),
            Shape::Box { width, height, length } => Some((
                DVec3::new(-0.5 * width, -0.5 * height, length.min(0.0)),
                DVec3::new(0.5 * width, 0.5 * height, length.max(0.0)),
            )),
            Shape::Cylinder { radius, length, .. } | Shape::Cone { radius, length, .. } => {
                round(radius, length)
            }
            Shape::Frustum { base_radius, top_radius, length, .. } => {
                round(base_radius.max(top_radius), length)
            }
            Shape::Parallelogram { length, axis, .. } => {
                let along = DVec3::new(0.0, 0.0, length);
                let corners = [-axis, axis, axis + along, along - axis];
                let low = corners.into_iter().fold(corners[0], DVec3::min);
                let high = corners.into_iter().fold(corners[0], DVec3::max);
                Some((low, high))
            }
            Shape::Plane | Shape::Mesh { .. } => None,
        }
    }
}
