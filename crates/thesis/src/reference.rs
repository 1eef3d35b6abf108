//! What the thesis measured (2008, chapter 5), in seconds, on a GeForce 6600 and one core of an AMD 1800+.

/// A row of its table 5.2: the bush without anti-aliasing.
pub(crate) struct BushRow {
    pub steps: i32,
    pub objects: usize,
    /// GroIMP's Twilight with its octree reduced to the root.
    pub twilight_flat: f64,
    /// The thesis's own GPU renderer, which had no acceleration structure.
    pub sunshine_2008: f64,
    /// Twilight with its octree.
    pub twilight: f64,
}

pub(crate) const BUSH: [BushRow; 5] = [
    BushRow { steps: 1, objects: 7, twilight_flat: 10.74, sunshine_2008: 15.89, twilight: 10.89 },
    BushRow { steps: 2, objects: 25, twilight_flat: 12.16, sunshine_2008: 17.61, twilight: 11.56 },
    BushRow { steps: 3, objects: 85, twilight_flat: 20.27, sunshine_2008: 20.26, twilight: 12.14 },
    BushRow { steps: 4, objects: 271, twilight_flat: 44.37, sunshine_2008: 27.86, twilight: 14.66 },
    BushRow { steps: 5, objects: 841, twilight_flat: 146.9, sunshine_2008: 39.20, twilight: 16.33 },
];

/// Figure 5.3: 715 x 458 pixels, one ray per pixel, 191 shadow rays.
pub(crate) const SOFT_SHADOW: Soft = Soft {
    width: 715,
    height: 458,
    shadow_rays: 191,
    sunshine_2008: 8.36,
    twilight: 20.5,
    path_tracer: 39.3,
};

pub(crate) struct Soft {
    pub width: u32,
    pub height: u32,
    pub shadow_rays: u32,
    pub sunshine_2008: f64,
    pub twilight: f64,
    /// Twilight's path tracer.
    pub path_tracer: f64,
}

/// Figure 5.6: 16 rays per pixel, 5,261,504 primary rays, recursion depth 3. That makes 718 x 458 pixels.
pub(crate) const CORNELL: Cornell =
    Cornell { width: 718, height: 458, samples: 16, depth: 3, sunshine_2008: 34.56 };

pub(crate) struct Cornell {
    pub width: u32,
    pub height: u32,
    pub samples: u32,
    pub depth: u32,
    pub sunshine_2008: f64,
}

/// Figure 5.1: sixteenfold anti-aliasing of one cylinder took Twilight this long; the thesis's times stand in the
/// figure alone.
pub(crate) const CYLINDER_TWILIGHT: f64 = 32.47;
