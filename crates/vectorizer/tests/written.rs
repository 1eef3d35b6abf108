//! What is written for small kernels. That the whole computes the same as without lanes is tested where it is executed,
//! in `render/tests/lanes.rs`.

#![allow(clippy::unwrap_used, reason = "in tests a panic is the failure report")]

use vectorizer::{Options, VectorizeError, vectorize};

fn written(wgsl: &str, root: (&str, &[bool])) -> Result<String, VectorizeError> {
    vectorize(wgsl, Options { roots: &[root], together: &[], target_features: "avx2" })
}

#[test]
fn what_is_the_same_for_all_rays_stays_plain() {
    let wgsl = "fn f(count: u32, x: f32) -> f32 {
        var sum = x;
        for (var i = 0u; i < count; i++) { sum += 0.5; }
        return sum;
    }";
    let text = written(wgsl, ("f", &[false, true])).unwrap();
    assert!(text.contains("a0: u32, a1: F32) -> F32"), "{text}");
    // The counter is a plain number, and the loop ends for all rays at once.
    assert!(text.contains(": u32 ="), "{text}");
    assert!(!text.contains("U32 ="), "{text}");
    let text = written(wgsl, ("f", &[true, true])).unwrap();
    assert!(
        text.contains("U32 ="),
        "a number of rounds that differs between rays has a counter for each: {text}"
    );
}

#[test]
fn conditions_that_differ_become_masks() {
    let wgsl = "fn f(x: f32) -> f32 {
        if x > 0.0 { return sqrt(x); }
        return 1.0;
    }";
    let text = written(wgsl, ("f", &[true])).unwrap();
    assert!(text.contains("live = and(before"), "{text}");
    assert!(text.contains("assign(live, &mut result"), "{text}");
    // Rays that have returned keep their result.
    assert!(text.contains("return blend(live, widen(1.0f32), result)"), "{text}");
    let text = written(wgsl, ("f", &[false])).unwrap();
    assert!(!text.contains("before"), "a condition that is the same for all rays is asked once: {text}");
}

#[test]
fn records_of_tables_are_passed_by_their_place() {
    let wgsl = "struct Leaf { area: f32, kind: u32 }
        @group(0) @binding(0) var<storage, read> LEAVES: array<Leaf>;
        fn area(leaf: Leaf) -> f32 { return leaf.area; }
        fn f(i: u32) -> f32 { return area(LEAVES[i]); }";
    let text = written(wgsl, ("f", &[true])).unwrap();
    assert!(text.contains("fn area(globals: &Globals<'_>, mask: Mask, a0: U32)"), "{text}");
    assert!(!text.contains("pub struct Leaf"), "{text}");
}

#[test]
fn rays_that_agree_take_another_form_of_a_function() {
    let wgsl = "struct Leaf { area: f32, kind: u32 }
        @group(0) @binding(0) var<storage, read> LEAVES: array<Leaf>;
        fn area(leaf: Leaf, x: f32) -> f32 { return leaf.area * x; }
        fn f(i: u32, x: f32) -> f32 { return area(LEAVES[i], x); }
        fn one(i: u32, x: f32) -> f32 { return area(LEAVES[i], x); }";
    let options = Options {
        roots: &[("f", &[true, true]), ("one", &[false, true])],
        together: &[("area", 0)],
        target_features: "avx2",
    };
    let text = vectorize(wgsl, options).unwrap();
    assert!(text.contains("fn area(globals: &Globals<'_>, mask: Mask, a0: U32, a1: F32) -> F32"), "{text}");
    assert!(text.contains("fn area_together(globals: &Globals<'_>, mask: Mask, a0: u32, a1: F32) -> F32"));
    // Where the leaf may differ the rays are asked; where it does not, they are not.
    let asked = "match together(live, ";
    assert_eq!(text.matches(asked).count(), 1, "{text}");
    assert!(text.contains("{ Some(one) => area_together(globals, live, one, a1), None => area("), "{text}");
    assert_eq!(text.matches("= area_together(globals, live").count(), 1, "{text}");
    let missing = vectorize(wgsl, Options { together: &[("g", 0)], ..options }).unwrap_err();
    assert_eq!(missing.to_string(), "the kernels have no function `g`");
}

#[test]
fn private_variables_outlive_the_call() {
    let wgsl = "var<private> waiting: array<u32, 48>;
        fn f(i: u32) -> u32 { waiting[i] = i; return waiting[i]; }";
    let text = written(wgsl, ("f", &[true])).unwrap();
    assert!(text.contains("pub waiting: RefCell<[U32; 48]>"), "{text}");
    assert!(text.contains("let mut own_waiting = globals.own.waiting.borrow_mut();"), "{text}");
}

#[test]
fn what_cannot_be_written_is_named() {
    let missing = written("fn f() -> f32 { return 1.0; }", ("g", &[])).unwrap_err();
    assert_eq!(missing.to_string(), "the kernels have no function `g`");
    let broken = written("fn f( {", ("f", &[])).unwrap_err();
    assert!(broken.to_string().starts_with("the kernels are no WGSL"), "{broken}");
    let wgsl = "fn f(x: vec2f) -> f32 { return length(x); }";
    let unsupported = written(wgsl, ("f", &[true])).unwrap_err().to_string();
    assert_eq!(unsupported, "function `f` uses the function Length, which has no form with lanes yet");
}
