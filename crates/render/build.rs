//! Writes the kernels with lanes for the vector units of processors, from the WGSL that graphics cards run.

use std::error::Error;
use std::path::PathBuf;

/// Functions, and the parameters of them on which rays often agree: lights are mostly compared for all rays at once.
const LIGHTS: &[(&str, usize)] = &[("light_importance", 0)];

/// In small scenes lights and materials are few.
const SHADING: &[(&str, usize)] =
    &[("sample_plain_light", 0), ("distant_radiance_Buffers", 1), ("material_bsdf_Buffers", 1)];

/// In small scenes, where every lane searches on its own, neighbours are often at the same node.
const SEARCH: &[(&str, usize)] = &[("reached_boxes", 0)];

fn main() -> Result<(), Box<dyn Error>> {
    let source = PathBuf::from("src/gpu/path_tracer.wgsl");
    println!("cargo::rerun-if-changed={}", source.display());
    println!("cargo::rerun-if-changed=build.rs");
    let wgsl = std::fs::read_to_string(&source)?;
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    let all = constant(&wgsl, "ALL_FEATURES")?;
    let mut plain = all & !(1 << constant(&wgsl, "SHAPE_TRIANGLE")?);
    for left_out in [
        "FEATURE_LOBES",
        "FEATURE_MEDIA",
        "FEATURE_PROGRAMS",
        "FEATURE_POSITIONS",
        "FEATURE_LIGHT_TABLES",
        "FEATURE_MANY_NODES",
    ] {
        plain &= !constant(&wgsl, left_out)?;
    }
    let declaration = |features: u32| format!("const FEATURES: u32 = {features}u;");
    let large = plain | constant(&wgsl, "FEATURE_MANY_NODES")?;
    let path_tracer: (&str, &[bool]) = ("render_pixel_Buffers", &[false, false, true, true, true]);
    for (unit, target_features) in [
        ("avx512", "avx512f,avx512bw,avx512dq,avx512vl,avx512cd,bmi1,bmi2,lzcnt,popcnt"),
        ("avx2", "avx2,bmi1,bmi2,lzcnt,popcnt"),
    ] {
        let alone = vectorizer::Options {
            roots: &[path_tracer],
            together: &[LIGHTS, SHADING, SEARCH].concat(),
            target_features,
        };
        let in_turns = vectorizer::Options {
            roots: &[
                ("sample_key", &[false, true, true, true]),
                ("start_sample", &[false, false, true, true, true, true]),
                ("next_query", &[true, true]),
                ("meet_object_Buffers", &[false, true, true, true, true, true]),
                ("is_dark", &[true]),
                ("continue_path_Buffers", &[false, true, false, false, true, true]),
            ],
            together: LIGHTS,
            ..alone
        };
        for (kind, features, options) in
            [("small", plain, alone), ("large", large, in_turns), ("general", all, in_turns)]
        {
            let wgsl = wgsl.replace(&declaration(all), &declaration(features));
            let kernels = vectorizer::vectorize(&wgsl, options)?;
            let text =
                format!("/// What scenes may have.\npub const FEATURES: u32 = {features};\n\n{kernels}");
            std::fs::write(out.join(format!("{kind}_{unit}.rs")), text)?;
        }
    }
    Ok(())
}

/// The number that a constant of the kernels has.
fn constant(wgsl: &str, name: &str) -> Result<u32, Box<dyn Error>> {
    let declaration = format!("const {name}: u32 = ");
    let (_, rest) =
        wgsl.split_once(&declaration).ok_or_else(|| format!("no `{declaration}` in the kernels"))?;
    let (number, _) = rest.split_once("u;").ok_or_else(|| format!("no number behind `{declaration}`"))?;
    Ok(number.parse()?)
}
