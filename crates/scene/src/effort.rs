use crate::{Channel, ChannelId, CoordinateMap, VolumeFunction};

/// What it takes to evaluate a channel at a point, in the worst case.
///
/// Channels may be nested as deep as one likes as long as a point leads to one of them: that costs time only once.
/// Blends and filters need several values, so a device must remember what it still has to do, and the number of
/// evaluations is multiplied from level to level. Both are bounded here; the bounds leave room for a filter of a
/// filter of five octaves of noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Elementary steps; a lattice noise counts as ten.
    pub steps: u64,
    /// What is to be remembered at a time: one for each blend, filter or coordinate that is a channel's value and
    /// that is under way.
    pub pending: u32,
}

const NOISE: u64 = 10;

impl Effort {
    /// The largest number of steps that is rendered.
    pub const MAX_STEPS: u64 = 1 << 16;
    /// The largest number of pending tasks that is rendered; the kernels' stack has this size.
    pub const MAX_PENDING: u32 = 8;

    /// Whether devices can evaluate the channel in reasonable time.
    pub fn is_bounded(self) -> bool {
        self.steps <= Effort::MAX_STEPS && self.pending <= Effort::MAX_PENDING
    }

    /// The effort for a channel, given that of the channels it refers to.
    pub fn of(channel: &Channel, known: impl Fn(ChannelId) -> Effort) -> Effort {
        let mut steps = 1u64;
        let mut pending = 0;
        for map in channel.coordinates() {
            steps = steps.saturating_add(match map {
                CoordinateMap::AffineUv { .. } | CoordinateMap::AffineXyz { .. } => 2,
                CoordinateMap::Turbulence { octaves, .. } => 6 * NOISE * u64::from(*octaves),
                CoordinateMap::Value(id) => {
                    let value = known(*id);
                    pending = pending.max(value.pending + 1);
                    value.steps.saturating_add(1)
                }
            });
        }
        let largest = channel
            .parts()
            .into_iter()
            .map(known)
            .reduce(|a, b| Effort { steps: a.steps.max(b.steps), pending: a.pending.max(b.pending) });
        let parts = largest.unwrap_or(Effort { steps: 0, pending: 0 });
        let (times, remembered, own) = match channel {
            Channel::Constant(_)
            | Channel::Rgba { .. }
            | Channel::ImageMap { .. }
            | Channel::Checker { .. }
            | Channel::VolumeChecker { .. }
            | Channel::Waves { .. } => (1, 0, 0),
            Channel::Volume { function, wave, .. } => (1, 0, volume_steps(function) + wave.len() as u64),
            Channel::Blend { items, .. } => (2, 1, items.len() as u64),
            Channel::Filter { .. } => (27, 1, 0),
        };
        Effort {
            steps: steps.saturating_add(parts.steps.saturating_mul(times)).saturating_add(own),
            pending: pending.max(parts.pending.saturating_add(remembered)),
        }
    }
}

fn volume_steps(function: &VolumeFunction) -> u64 {
    match function {
        VolumeFunction::Gradient { .. } | VolumeFunction::Wood | VolumeFunction::Leopard => 1,
        VolumeFunction::Granite => 6 * NOISE,
        VolumeFunction::Fractal { iterations, .. } => u64::from(*iterations),
        VolumeFunction::Turbulence { octaves, .. } => NOISE * u64::from(*octaves),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NeighbourFilter, Scene};
    use glam::DVec3;

    #[test]
    fn nested_filters_multiply_and_checkers_do_not() {
        let mut scene = Scene::default();
        let mut efforts: Vec<Effort> = Vec::new();
        let mut add = |channel: Channel| {
            efforts.push(Effort::of(&channel, |id| efforts[id.index()]));
            scene.add_channel(channel)
        };
        let mut last = add(Channel::Constant([1.0; 3]));
        for _ in 0..1000 {
            last = add(Channel::Checker { odd: last, even: last, coordinates: vec![] });
        }
        for _ in 0..2 {
            let step = DVec3::ONE;
            last = add(Channel::Filter { weights: NeighbourFilter::Smooth, step, input: last });
        }
        assert_eq!(efforts[1000], Effort { steps: 1001, pending: 0 });
        assert_eq!(efforts[1001], Effort { steps: 27 * 1001 + 1, pending: 1 });
        assert!(efforts[1001].is_bounded() && !efforts[1002].is_bounded());
    }
}
