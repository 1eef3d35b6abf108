//! A picture that is known, with noise that is known. Without the library nothing is tested, and that is said.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use denoise::{DenoiseError, Denoiser, Noisy};

const WIDTH: usize = 96;
const HEIGHT: usize = 64;

fn denoiser() -> Option<Denoiser> {
    match Denoiser::open(Some(2)) {
        Ok(denoiser) => Some(denoiser),
        Err(error @ DenoiseError::NotFound { .. }) => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// A dark and a bright half in radiance far above 1, whose edge the albedo shows.
fn exact(x: usize) -> [f32; 3] {
    if x < WIDTH / 2 { [20.0, 40.0, 60.0] } else { [400.0, 300.0, 200.0] }
}

#[test]
fn noise_goes_and_the_picture_stays() {
    let Some(denoiser) = denoiser() else { return };
    assert!(denoiser.to_string().starts_with("Open Image Denoise 2."), "{denoiser}");
    // A linear congruential generator (Knuth's MMIX) is good enough for noise of 50 %.
    let mut state = 1u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    let pixels = || (0..HEIGHT).flat_map(|_| (0..WIDTH).map(exact));
    let radiance: Vec<[f32; 3]> = pixels().map(|pixel| pixel.map(|value| value * 2.0 * uniform())).collect();
    let albedo: Vec<[f32; 3]> = pixels().map(|pixel| pixel.map(|value| value / 500.0)).collect();
    let normal = vec![[0.0, 0.0, 1.0]; WIDTH * HEIGHT];
    let noisy = Noisy { width: WIDTH, height: HEIGHT, radiance: &radiance, albedo: &albedo, normal: &normal };
    let denoised = denoiser.denoise(&noisy).unwrap();
    let error = |picture: &[[f32; 3]]| {
        let squares = picture.iter().zip(pixels()).map(|(a, b)| (f64::from(a[0]) - f64::from(b[0])).powi(2));
        (squares.sum::<f64>() / picture.len() as f64).sqrt()
    };
    let mean = |picture: &[[f32; 3]]| picture.iter().map(|p| f64::from(p[0])).sum::<f64>();
    // Thousands of pixels with the same truth: nearly all noise can go.
    assert!(error(&denoised) < 0.25 * error(&radiance), "{} {}", error(&denoised), error(&radiance));
    // The mean of the noise itself is known to 0.6/√6144 = 0.7 %.
    let ratio = mean(&denoised) / pixels().map(|p| f64::from(p[0])).sum::<f64>();
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
    // Once more gives the same.
    assert_eq!(denoiser.denoise(&noisy).unwrap(), denoised);
}

#[test]
fn nothing_becomes_nothing() {
    let Some(denoiser) = denoiser() else { return };
    let none = Noisy { width: 0, height: 7, radiance: &[], albedo: &[], normal: &[] };
    assert!(denoiser.denoise(&none).unwrap().is_empty());
    // One pixel is a picture, too.
    let one = [[2.0, 1.0, 0.5]];
    let one = denoiser.denoise(&Noisy { width: 1, height: 1, radiance: &one, albedo: &one, normal: &one });
    assert!(one.unwrap()[0].iter().all(|value| value.is_finite()));
}
