//! Binary trees over boxes, from which the hierarchies of the kernels are folded: built by `obvhs` for little
//! expected work, or by halving for little depth.

use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::builder::build_bvh2};
use scene::DVec3;
use std::ops::Range;
use std::time::Duration;

/// Up to so many boxes every node is tried at another place, twice, which takes half a second for 100,000 and saves a
/// sixth of the nodes that rays visit there; above only the worst.
const THOROUGH_BOXES: usize = 300_000;

/// A tree with one box in every leaf.
pub(super) struct BinaryTree {
    nodes: Vec<BinaryNode>,
}

struct BinaryNode {
    aabb: Aabb,
    below: Below,
}

#[derive(Clone, Copy)]
enum Below {
    /// Both children, the second one behind the first.
    Children(usize),
    /// Number of a box.
    Box(u32),
}

/// Number of a node.
pub(super) type NodeNumber = usize;

impl BinaryTree {
    /// A tree in which a ray is expected to meet few nodes (surface area heuristic; Meister and Bittner, "Parallel
    /// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", 2018, and reinsertion).
    pub fn by_surface_area(boxes: &[Aabb]) -> Self {
        let base = if boxes.len() <= THOROUGH_BOXES {
            BvhBuildParams::very_slow_build()
        } else {
            BvhBuildParams::medium_build()
        };
        let params = BvhBuildParams { max_prims_per_leaf: 1, pre_split: false, ..base };
        let bvh = build_bvh2(boxes, params, &mut Duration::default());
        if bvh.nodes.is_empty() {
            return Self::of_least_depth(boxes);
        }
        let mut tree = BinaryTree { nodes: Vec::with_capacity(bvh.nodes.len()) };
        tree.nodes.extend(bvh.nodes.iter().map(|node| {
            let first = node.first_index as usize;
            let below = if node.is_leaf() {
                Below::Box(bvh.primitive_indices.get(first).copied().unwrap_or(node.first_index))
            } else {
                Below::Children(first)
            };
            BinaryNode { aabb: *node.aabb(), below }
        }));
        // Boxes that share a leaf in spite of the parameters.
        for number in 0..bvh.nodes.len() {
            let node = &bvh.nodes[number];
            if node.is_leaf() && node.prim_count > 1 {
                let first = node.first_index as usize;
                let mut members = bvh.primitive_indices[first..first + node.prim_count as usize].to_vec();
                tree.halve(boxes, number, &mut members);
            }
        }
        tree
    }

    /// A tree that is as flat as a binary one can be: boxes are halved along the longest axis again and again.
    pub fn of_least_depth(boxes: &[Aabb]) -> Self {
        let mut members: Vec<u32> = (0..).zip(boxes).map(|(index, _)| index).collect();
        let root = BinaryNode { aabb: Aabb::empty(), below: Below::Box(0) };
        let mut tree = BinaryTree { nodes: vec![root] };
        tree.halve(boxes, 0, &mut members);
        tree
    }

    /// Puts some boxes below a node.
    fn halve(&mut self, boxes: &[Aabb], number: NodeNumber, members: &mut [u32]) {
        let mut open: Vec<(NodeNumber, Range<usize>)> = vec![(number, 0..members.len())];
        while let Some((number, range)) = open.pop() {
            let here = &mut members[range.clone()];
            let aabb = here.iter().fold(Aabb::empty(), |all, &index| all.union(&boxes[index as usize]));
            self.nodes[number].aabb = aabb;
            if let [single] = here {
                self.nodes[number].below = Below::Box(*single);
                continue;
            }
            let extent = aabb.diagonal();
            let axis = if extent.x >= extent.y && extent.x >= extent.z {
                0
            } else if extent.y >= extent.z {
                1
            } else {
                2
            };
            let half = here.len() / 2;
            here.select_nth_unstable_by(half, |a, b| {
                boxes[*a as usize].center()[axis].total_cmp(&boxes[*b as usize].center()[axis])
            });
            let left = self.nodes.len();
            self.nodes[number].below = Below::Children(left);
            for part in [range.start..range.start + half, range.start + half..range.end] {
                open.push((self.nodes.len(), part));
                self.nodes.push(BinaryNode { aabb: Aabb::empty(), below: Below::Box(0) });
            }
        }
    }

    /// All nodes that belong to the tree, children before their parents.
    pub fn bottom_up(&self) -> impl Iterator<Item = NodeNumber> + use<> {
        let mut visited = Vec::with_capacity(self.nodes.len());
        let mut open = vec![self.root()];
        while let Some(number) = open.pop() {
            visited.push(number);
            if let Below::Children(left) = self.nodes[number].below {
                open.extend([left, left + 1]);
            }
        }
        visited.into_iter().rev()
    }

    /// Number of nodes; some may not belong to the tree.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn root(&self) -> NodeNumber {
        0
    }

    pub fn aabb(&self, node: NodeNumber) -> &Aabb {
        &self.nodes[node].aabb
    }

    /// Both children of a node, unless it is a leaf.
    pub fn halves(&self, node: NodeNumber) -> Option<[NodeNumber; 2]> {
        match self.nodes[node].below {
            Below::Children(left) => Some([left, left + 1]),
            Below::Box(_) => None,
        }
    }

    /// Number of the box that a leaf holds.
    pub fn single_box(&self, node: NodeNumber) -> Option<u32> {
        match self.nodes[node].below {
            Below::Children(_) => None,
            Below::Box(index) => Some(index),
        }
    }
}

/// A box in 32 bits that contains the exact one, and what rounding in the intersection may add.
pub(super) fn rounded_outwards(low: DVec3, high: DVec3) -> Aabb {
    let margin = (low.abs().max(high.abs()) * 4e-7).max(DVec3::splat(1e-30));
    let (low, high) = (low - margin, high + margin);
    Aabb::new(
        [low.x as f32, low.y as f32, low.z as f32].into(),
        [high.x as f32, high.y as f32, high.z as f32].into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_in_32_bits_contain_the_exact_ones() {
        let (low, high) = (DVec3::new(0.1, -1000.1, 5e-8), DVec3::new(0.1, 1000.3, 6e-8));
        let aabb = rounded_outwards(low, high);
        let (min, max) = (aabb.min.to_array().map(f64::from), aabb.max.to_array().map(f64::from));
        assert!(min[0] < low.x && min[1] < low.y && min[2] < low.z);
        assert!(max[0] > high.x && max[1] > high.y && max[2] > high.z);
    }

    #[test]
    fn every_box_is_below_the_root_once() {
        let boxes: Vec<Aabb> = (0..100u32)
            .map(|i| {
                let low = DVec3::new(f64::from(i * 7 % 13), f64::from(i % 5), f64::from(i / 50));
                rounded_outwards(low, low + DVec3::ONE)
            })
            .collect();
        for number in [1, 2, 3, 100] {
            let boxes = &boxes[..number];
            for tree in [BinaryTree::by_surface_area(boxes), BinaryTree::of_least_depth(boxes)] {
                let mut found: Vec<u32> = tree.bottom_up().filter_map(|node| tree.single_box(node)).collect();
                found.sort_unstable();
                assert_eq!(found, (0..number as u32).collect::<Vec<_>>());
            }
        }
    }
}
