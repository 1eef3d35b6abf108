//! Materials that would give back more light than they get. The renderer scales them down; here they are named.

use crate::report::Report;
use scene::{Channel, ChannelId, Image, Material, MaterialId, Origin, Phong, Rgb, Scene, TypeNameId};
use std::collections::{BTreeMap, HashMap};

/// Sums up to this much above 1 are taken for rounding of what a user wrote.
const TOLERANCE: f64 = 1e-3;

/// Shaders of one type of object that give back too much.
struct Gains {
    materials: usize,
    /// An object that has the worst of them.
    node: i64,
    largest: f64,
}

/// Warns of the materials of objects whose coefficients add up to more than 1 somewhere, once for every type of
/// object.
pub(crate) fn warn_of_gains(scene: &Scene, report: &mut Report) {
    let maxima = channel_maxima(scene);
    let mut by_type: BTreeMap<TypeNameId, Gains> = BTreeMap::new();
    let mut seen = vec![false; scene.materials.len()];
    for object in scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects)) {
        for material in sides(scene, object.material) {
            if std::mem::replace(&mut seen[material.index()], true) {
                continue;
            }
            let largest = match &scene.materials[material.index()] {
                Material::Rgba { color, opacity } => largest(color.map(|c| opacity * c + 1.0 - opacity)),
                Material::Phong(phong) => phong_maximum(scene, phong, &maxima),
                Material::SideSwitch { .. } => 0.0,
            };
            if largest <= 1.0 + TOLERANCE {
                continue;
            }
            let Origin { node, type_name } = object.origin;
            let gains = by_type.entry(type_name).or_insert(Gains { materials: 0, node, largest });
            gains.materials += 1;
            if largest > gains.largest {
                (gains.node, gains.largest) = (node, largest);
            }
        }
    }
    for (type_name, Gains { materials, node, largest }) in by_type {
        let type_name = scene.type_names.get(type_name.index()).map_or("an object", String::as_str);
        let more = match materials {
            1 => String::new(),
            n => format!(" and {} more of this type", n - 1),
        };
        let message = format!(
            "the shader of {type_name} (node {node}{more}) gives back up to {largest:.3} times the light that it gets; \
             it is scaled down to 1 wherever it would be more"
        );
        report.warn(message, None);
    }
}

/// The material itself, or those of its sides.
fn sides(scene: &Scene, material: MaterialId) -> Vec<MaterialId> {
    match scene.materials[material.index()] {
        Material::SideSwitch { front, back } => vec![front, back],
        Material::Rgba { .. } | Material::Phong(_) => vec![material],
    }
}

/// The largest sum of the coefficients of any colour.
fn phong_maximum(scene: &Scene, phong: &Phong, maxima: &[Rgb]) -> f64 {
    let of = |channel: Option<ChannelId>| channel.map_or([0.0; 3], |id| maxima[id.index()]);
    let (diffuse, specular) = (of(phong.diffuse), of(phong.specular));
    let (clear, through) = (of(phong.transparency), of(phong.diffuse_transparency));
    let is_constant = |id: ChannelId| matches!(scene.channels[id.index()], Channel::Constant(_));
    // Transparency that varies may be 0 where the rest is largest.
    let varies = phong.transparency.is_some_and(|id| !is_constant(id));
    let sum = |c: usize| {
        let reflected = diffuse[c] + specular[c];
        if !phong.interpolated_transparency {
            return reflected + clear[c] + through[c];
        }
        let tau = clear[c].clamp(0.0, 1.0);
        let mixed = (1.0 - tau) * reflected + tau + through[c];
        if varies { mixed.max(reflected + through[c]) } else { mixed }
    };
    largest([sum(0), sum(1), sum(2)])
}

/// The largest value of every channel, per colour; 1 where a function decides.
fn channel_maxima(scene: &Scene) -> Vec<Rgb> {
    let mut of_images: HashMap<scene::ImageId, Rgb> = HashMap::new();
    let mut maxima: Vec<Rgb> = Vec::with_capacity(scene.channels.len());
    for channel in &scene.channels {
        let largest = match channel {
            Channel::Constant(color) | Channel::Rgba { color, .. } => color.map(|c| c.max(0.0)),
            Channel::ImageMap { image, .. } => {
                *of_images.entry(*image).or_insert_with(|| image_maximum(&scene.images[image.index()]))
            }
            Channel::Volume { .. } | Channel::Waves { .. } => [1.0; 3],
            Channel::Checker { .. }
            | Channel::VolumeChecker { .. }
            | Channel::Blend { .. }
            | Channel::Filter { .. } => {
                let known = channel.parts().into_iter().filter_map(|id| maxima.get(id.index()));
                known.fold([0.0; 3], |all: Rgb, part| [0, 1, 2].map(|c| all[c].max(part[c])))
            }
        };
        maxima.push(largest);
    }
    maxima
}

/// The largest linear values of an image where it is not cut out.
fn image_maximum(image: &Image) -> Rgb {
    let seen = image.pixels.iter().filter(|pixel| pixel[3] > 0);
    let largest = seen.fold([0u8; 3], |all, pixel| [0, 1, 2].map(|c| all[c].max(pixel[c])));
    // The sRGB curve leads from 0 to 0 and from 1 to 1, and below it in between.
    largest.map(|value| f64::from(value) / 255.0)
}

fn largest([r, g, b]: Rgb) -> f64 {
    r.max(g).max(b)
}
