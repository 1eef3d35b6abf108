//! What is in a group as some boxes, so that the boxes of its instances can be small.
//!
//! A box that is turned with its plant has a larger one around it; around many small ones that are turned there is hardly
//! more than around the plant itself.

use super::binary::{BinaryTree, NodeNumber};
use scene::{DAffine3, DVec3, transformed_box};

/// Boxes of an outline at most; more save nothing.
const MOST_BOXES: usize = 64;
/// Boxes at least, and how many are turned for all instances together before there are fewer: a hundred take a
/// microsecond.
const LEAST_BOXES: usize = 8;
const TURNED_BOXES: usize = 1 << 22;

/// Boxes around all that is in a group, in its space.
pub(super) struct Outline {
    boxes: Vec<(DVec3, DVec3)>,
}

impl Outline {
    /// That of a group, given its tree, of which there are so many instances.
    pub fn new(tree: &BinaryTree, instances: usize) -> Self {
        let most = (TURNED_BOXES / instances.max(1)).clamp(LEAST_BOXES, MOST_BOXES);
        let area = |&node: &NodeNumber| tree.aabb(node).half_area();
        let mut parts = vec![tree.root()];
        // The largest are divided first.
        while parts.len() < most {
            let divisible = (0..parts.len()).filter_map(|place| Some((place, tree.halves(parts[place])?)));
            let largest = divisible.max_by(|(a, _), (b, _)| area(&parts[*a]).total_cmp(&area(&parts[*b])));
            let Some((place, halves)) = largest else { break };
            parts.swap_remove(place);
            parts.extend(halves);
        }
        let corner = |corner: [f32; 3]| DVec3::from(corner.map(f64::from));
        let corners = |part| {
            let aabb = tree.aabb(part);
            (corner(aabb.min.to_array()), corner(aabb.max.to_array()))
        };
        Outline { boxes: parts.into_iter().map(corners).collect() }
    }

    /// A box around the group at a place.
    pub fn bounds(&self, local_from_group: &DAffine3) -> (DVec3, DVec3) {
        self.boxes
            .iter()
            .map(|&part| transformed_box(part, local_from_group))
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |all, part| (all.0.min(part.0), all.1.max(part.1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::binary::rounded_outwards;

    #[test]
    fn the_box_of_a_turned_group_contains_its_members_and_little_more() {
        // A thick round trunk of short pieces.
        let place = |i: u32| {
            let angle = f64::from(i) * 2.4;
            DVec3::new(angle.cos(), angle.sin(), f64::from(i) / 100.0)
        };
        let members: Vec<(DVec3, DVec3)> = (0..500).map(|i| (place(i) - 0.01, place(i) + 0.01)).collect();
        let boxes: Vec<_> = members.iter().map(|&(low, high)| rounded_outwards(low, high)).collect();
        let tree = BinaryTree::by_surface_area(&boxes);
        for instances in [1, 1 << 20] {
            let outline = Outline::new(&tree, instances);
            for angle in [0.0, 0.4, 0.785] {
                let placed = DAffine3::from_rotation_z(angle);
                let (low, high) = outline.bounds(&placed);
                for (member_low, member_high) in &members {
                    let middle = placed.transform_point3(0.5 * (member_low + member_high));
                    assert!(middle.cmpge(low).all() && middle.cmple(high).all());
                }
                // One box would be 2.86 wide at the worst angle.
                let width = (high - low).x;
                assert!((2.0..if instances == 1 { 2.4 } else { 2.86 }).contains(&width), "{angle} {width}");
            }
        }
    }
}
