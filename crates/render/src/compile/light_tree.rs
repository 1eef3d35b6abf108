//! The tree of lights: neighbours in space under one group, four children to a group.

use super::lights::dark;
use super::{count, vector};
use kernels::records::kernel::{LIGHT_GROUP, LightRecord, NONE};
use scene::DVec3;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::ops::Range;

/// So many lights are looked at one by one.
const LOOP: usize = 8;
/// Added to the angle within which a group shines, since graphics cards compute angles only roughly.
const SLACK: f64 = 0.01;

/// A light with a place.
pub(super) struct Placed {
    pub record: LightRecord,
    /// Centre and radius of a sphere that holds it.
    pub centre: DVec3,
    pub radius: f64,
    /// It shines at smaller angles from its axis than this, in radians.
    pub limit: f64,
    /// The object that it is.
    pub object: Option<usize>,
}

impl Placed {
    fn axis(&self) -> DVec3 {
        let axis = self.record.axis;
        DVec3::new(axis.x.into(), axis.y.into(), axis.z.into())
    }
}

/// Appends the lights and the groups above them to the table and notes which objects are which light. Returns the
/// number of records without a parent; they come first, after those that were in the table.
pub(super) fn arrange(mut placed: Vec<Placed>, records: &mut Vec<LightRecord>, of_object: &mut [u32]) -> u32 {
    let mut top = records.len();
    let mut open = VecDeque::from([(0..placed.len(), NONE)]);
    while let Some((range, parent)) = open.pop_front() {
        let parts = divide(&mut placed, range);
        if parent == NONE {
            top += parts.len();
        } else {
            let first = count(records.len());
            let group = &mut records[parent as usize];
            (group.first, group.count) = (first, count(parts.len()));
        }
        for part in parts {
            let index = count(records.len());
            if let [only] = &placed[part.clone()] {
                records.push(LightRecord { parent, ..only.record });
                if let Some(object) = only.object {
                    of_object[object] = index;
                }
            } else {
                records.push(group(&placed[part.clone()], parent));
                open.push_back((part, index));
            }
        }
    }
    count(top)
}

/// Single lights if there are few, else four parts of equal numbers, halved twice along the longest extent.
fn divide(placed: &mut [Placed], range: Range<usize>) -> Vec<Range<usize>> {
    if range.len() <= LOOP {
        return range.map(|i| i..i + 1).collect();
    }
    let middle = halve(placed, range.clone());
    let first = halve(placed, range.start..middle);
    let last = halve(placed, middle..range.end);
    vec![range.start..first, first..middle, middle..last, last..range.end]
}

fn halve(placed: &mut [Placed], range: Range<usize>) -> usize {
    let part = &mut placed[range.clone()];
    let low = part.iter().fold(DVec3::INFINITY, |low, light| low.min(light.centre));
    let high = part.iter().fold(DVec3::NEG_INFINITY, |high, light| high.max(light.centre));
    let axis = (high - low).max_position();
    let middle = part.len() / 2;
    part.select_nth_unstable_by(middle, |a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    range.start + middle
}

fn group(lights: &[Placed], parent: u32) -> LightRecord {
    let low = lights.iter().fold(DVec3::INFINITY, |low, light| low.min(light.centre));
    let high = lights.iter().fold(DVec3::NEG_INFINITY, |high, light| high.max(light.centre));
    let centre = 0.5 * (low + high);
    let radius = lights.iter().map(|l| (l.centre - centre).length() + l.radius).fold(0.0, f64::max);
    let axis = lights.iter().map(Placed::axis).sum::<DVec3>().normalize_or(DVec3::Z);
    let limit = lights
        .iter()
        .map(|light| light.axis().dot(axis).clamp(-1.0, 1.0).acos() + light.limit)
        .fold(0.0, f64::max);
    LightRecord {
        position: vector(centre),
        axis: vector(axis),
        // Rounded up a little, so that no light is left out.
        cos_inner: (radius * radius * 1.001) as f32,
        cos_outer: (limit + SLACK).min(PI) as f32,
        importance: lights.iter().map(|light| f64::from(light.record.importance)).sum::<f64>() as f32,
        parent,
        ..dark(LIGHT_GROUP)
    }
}
