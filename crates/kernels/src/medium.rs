//! Refraction: Fresnel's equations, and which media a path is inside of (materials-and-lights.md 1.6).

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use wgsl_rs::std::*;

    /// The bodies that a path has entered and not left, innermost first. Four are remembered; what lies round
    /// a fifth counts as empty space.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct Media {
        /// Refractive indices; 1 where there is no body.
        pub indices: Vec4f,
        /// What tells the bodies apart, or `NONE`.
        pub bodies: Vec4u,
    }

    pub fn empty_space() -> Media {
        Media { indices: vec4f(1.0, 1.0, 1.0, 1.0), bodies: vec4u(NONE, NONE, NONE, NONE) }
    }

    /// The media inside of a body that is entered.
    pub fn enter_medium(media: Media, body: u32, index: f32) -> Media {
        let i = media.indices;
        let b = media.bodies;
        Media { indices: vec4f(index, i.x, i.y, i.z), bodies: vec4u(body, b.x, b.y, b.z) }
    }

    /// The media outside of a body that is left, which need not be the innermost.
    pub fn leave_medium(media: Media, body: u32) -> Media {
        let i = media.indices;
        let b = media.bodies;
        if b.x == body {
            return Media { indices: vec4f(i.y, i.z, i.w, 1.0), bodies: vec4u(b.y, b.z, b.w, NONE) };
        }
        if b.y == body {
            return Media { indices: vec4f(i.x, i.z, i.w, 1.0), bodies: vec4u(b.x, b.z, b.w, NONE) };
        }
        if b.z == body {
            return Media { indices: vec4f(i.x, i.y, i.w, 1.0), bodies: vec4u(b.x, b.y, b.w, NONE) };
        }
        if b.w == body {
            return Media { indices: vec4f(i.x, i.y, i.z, 1.0), bodies: vec4u(b.x, b.y, b.z, NONE) };
        }
        media
    }

    /// Square of the cosine behind the surface; negative for total reflection. `eta` is the refractive index on
    /// the side of arrival divided by the one behind, `cosine` that of arrival.
    pub fn refracted_cosine_squared(eta: f32, cosine: f32) -> f32 {
        1.0 - eta * eta * (1.0 - cosine * cosine)
    }

    /// Share of unpolarised light that is reflected; 0 between equal media.
    pub fn fresnel_reflectance(eta: f32, cosine: f32) -> f32 {
        if eta == 1.0 {
            return 0.0;
        }
        let squared = refracted_cosine_squared(eta, cosine);
        if squared <= 0.0 {
            return 1.0;
        }
        let behind = sqrt(squared);
        let across = (behind - eta * cosine) / (behind + eta * cosine);
        let along = (cosine - eta * behind) / (cosine + eta * behind);
        0.5 * (across * across + along * along)
    }

    /// Direction in which light that arrives from `wo` goes on behind the surface; `normal` is on the side of `wo`.
    /// With total reflection, where nothing goes on, it is straight.
    pub fn refracted_direction(eta: f32, normal: Vec3f, wo: Vec3f) -> Vec3f {
        let cosine = dot(normal, wo);
        let squared = refracted_cosine_squared(eta, cosine);
        if eta == 1.0 || squared <= 0.0 {
            return -wo;
        }
        normalize(-wo * eta + normal * (eta * cosine - sqrt(squared)))
    }
}

#[cfg(test)]
mod tests {
    use super::kernel::*;
    use crate::records::kernel::NONE;
    use wgsl_rs::std::*;

    #[test]
    fn bodies_are_left_in_any_order() {
        let inside = enter_medium(enter_medium(enter_medium(empty_space(), 1, 1.3), 2, 1.5), 3, 1.1);
        assert_eq!(inside.indices.x, 1.1);
        let without_middle = leave_medium(inside, 2);
        assert_eq!((without_middle.indices.x, without_middle.indices.y), (1.1, 1.3));
        let outermost = leave_medium(without_middle, 3);
        assert_eq!((outermost.indices.x, outermost.bodies.x), (1.3, 1));
        let space = leave_medium(outermost, 1);
        assert_eq!((space.indices.x, space.bodies.x), (1.0, NONE));
        assert_eq!(leave_medium(space, 7).indices.x, 1.0);
    }

    #[test]
    fn fresnel_has_its_known_values() {
        // Glass seen straight on reflects 4 %, from both sides.
        assert!((fresnel_reflectance(1.0 / 1.5, 1.0) - 0.04).abs() < 1e-6);
        assert!((fresnel_reflectance(1.5, 1.0) - 0.04).abs() < 1e-6);
        // At Brewster's angle only one polarisation is reflected: half of ((n² - 1) / (n² + 1))².
        let cosine = (1.0f32 / (1.0 + 1.5 * 1.5)).sqrt();
        let one_polarisation = ((1.5f32 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0)).powi(2);
        assert!((fresnel_reflectance(1.0 / 1.5, cosine) - 0.5 * one_polarisation).abs() < 1e-6);
        // Beyond the critical angle all is reflected.
        let critical = (1.0f32 - 1.0 / 2.25).sqrt();
        assert_eq!(fresnel_reflectance(1.5, critical - 0.01), 1.0);
        assert!(fresnel_reflectance(1.5, critical + 0.01) < 1.0);
        assert_eq!(fresnel_reflectance(1.0, 0.3), 0.0);
    }

    #[test]
    fn refraction_obeys_snell() {
        let normal = vec3f(0.0, 0.0, 1.0);
        for degrees in [0.0f32, 10.0, 45.0, 80.0] {
            let angle = degrees.to_radians();
            let wo = vec3f(angle.sin(), 0.0, angle.cos());
            let t = refracted_direction(1.0 / 1.33, normal, wo);
            assert!((t.x + angle.sin() / 1.33).abs() < 1e-6 && t.z < 0.0);
            // Back on the same way.
            let back = refracted_direction(1.33, -normal, t);
            let error = back - wo;
            assert!(dot(error, error) < 1e-10);
        }
    }
}
