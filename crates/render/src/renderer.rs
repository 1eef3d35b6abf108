//! The two renderers.

use kernels::records::kernel::{RENDERER_PATH_TRACER, RENDERER_RAY_TRACER};
use std::str::FromStr;

/// How light is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Renderer {
    /// All light that physics knows, with noise: the rendering equation (Kajiya 1986).
    #[default]
    PathTracer,
    /// Local illumination, shadows, ideal reflection and refraction (Whitted 1980), as GroIMP's own ray tracer.
    RayTracer,
}

impl Renderer {
    /// All of them.
    pub const ALL: [Self; 2] = [Renderer::PathTracer, Renderer::RayTracer];

    /// What users call it.
    pub fn name(self) -> &'static str {
        match self {
            Renderer::PathTracer => "pathtracer",
            Renderer::RayTracer => "raytracer",
        }
    }

    /// What the kernels call it.
    pub(crate) fn number(self) -> u32 {
        match self {
            Renderer::PathTracer => RENDERER_PATH_TRACER,
            Renderer::RayTracer => RENDERER_RAY_TRACER,
        }
    }

    /// The kernel that makes its samples.
    pub(crate) fn kernel(self) -> &'static str {
        match self {
            Renderer::PathTracer => "add_path_samples",
            Renderer::RayTracer => "add_ray_samples",
        }
    }
}

impl std::fmt::Display for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Renderer {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|renderer| renderer.name() == text)
            .ok_or_else(|| format!("`{text}` is no renderer; use pathtracer or raytracer"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for renderer in Renderer::ALL {
            assert_eq!(renderer.to_string().parse(), Ok(renderer));
        }
        assert!("radiosity".parse::<Renderer>().is_err());
    }
}
