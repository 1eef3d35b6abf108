//! Which nodes of a binary tree become nodes with eight children, so that a ray is expected to visit few of them
//! (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017,
//! section 4).
//!
//! A ray visits a node with a probability in proportion to the surface of its box. So the surfaces of all wide nodes
//! are to be least in sum; which is the sum over the parts of a tree, and therefore found from the leaves to the root.

use super::binary::{BinaryTree, NodeNumber};

/// Children of a node at most.
pub(super) const CHILDREN: usize = 8;

/// Least surfaces of the wide nodes below the nodes of a binary tree.
pub(super) struct Collapse<'a> {
    tree: &'a BinaryTree,
    /// For every node the least sum if what is below becomes at most 1, 2, ... 7 children of a wide node.
    least: Vec<[f32; CHILDREN - 1]>,
}

impl<'a> Collapse<'a> {
    /// Finds the least sums.
    pub fn new(tree: &'a BinaryTree) -> Self {
        let mut collapse = Collapse { tree, least: vec![[0.0; CHILDREN - 1]; tree.len()] };
        for node in tree.bottom_up() {
            // Leaves are there in any case and count for nothing.
            let Some(halves) = tree.halves(node) else { continue };
            let mut least = [tree.aabb(node).half_area() + collapse.spread(halves, CHILDREN).0; CHILDREN - 1];
            for children in 2..CHILDREN {
                let spread = collapse.spread(halves, children).0;
                least[children - 1] = least[children - 2].min(spread);
            }
            collapse.least[node] = least;
        }
        collapse
    }

    fn least(&self, node: NodeNumber, children: usize) -> f32 {
        self.least[node][children - 1]
    }

    /// The least sum if two halves become `children` in all, at least two, and how many the first half becomes.
    fn spread(&self, [left, right]: [NodeNumber; 2], children: usize) -> (f32, usize) {
        (1..children)
            .map(|first| (self.least(left, first) + self.least(right, children - first), first))
            .fold((f32::INFINITY, 1), |best, next| if next.0 < best.0 { next } else { best })
    }

    /// The children of the wide node that stands for a binary node: leaves, or binary nodes that become wide ones.
    pub fn children(&self, node: NodeNumber) -> Vec<NodeNumber> {
        let Some(halves) = self.tree.halves(node) else { return vec![node] };
        let mut children = Vec::with_capacity(CHILDREN);
        let divide = |[left, right]: [NodeNumber; 2], count: usize| {
            let first = self.spread([left, right], count).1;
            [(right, count - first), (left, first)]
        };
        let mut open = divide(halves, CHILDREN).to_vec();
        while let Some((part, count)) = open.pop() {
            match self.tree.halves(part) {
                Some(halves) if count > 1 && self.spread(halves, count).0 <= self.least(part, 1) => {
                    open.extend(divide(halves, count));
                }
                _ => children.push(part),
            }
        }
        children
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use obvhs::aabb::Aabb;

    fn boxes(count: u32) -> Vec<Aabb> {
        // Somewhere in a room, as a multiplicative sequence throws them.
        let coordinate = |i: u32, factor: f64| (f64::from(i) * factor).fract() as f32;
        (0..count)
            .map(|i| {
                let low = [
                    coordinate(i, 0.754_877_666),
                    coordinate(i, 0.569_840_291),
                    coordinate(i, 0.618_033_989),
                ];
                Aabb::new(low.into(), low.map(|x| x + 0.05).into())
            })
            .collect()
    }

    /// Surfaces of the wide nodes that `children` makes, and the leaves below them.
    fn folded(tree: &BinaryTree, children: &dyn Fn(NodeNumber) -> Vec<NodeNumber>) -> (f32, usize) {
        let (mut surfaces, mut leaves) = (0.0, 0);
        let mut open = vec![tree.root()];
        while let Some(node) = open.pop() {
            if tree.halves(node).is_none() {
                leaves += 1;
                continue;
            }
            surfaces += tree.aabb(node).half_area();
            let children = children(node);
            assert!((2..=CHILDREN).contains(&children.len()));
            open.extend(children);
        }
        (surfaces, leaves)
    }

    #[test]
    fn the_least_sum_is_reached_and_less_than_by_opening_the_largest() {
        for count in [2, 3, 9, 70, 1000, 100_000] {
            let tree = BinaryTree::by_surface_area(&boxes(count));
            let collapse = Collapse::new(&tree);
            let (surfaces, leaves) = folded(&tree, &|node| collapse.children(node));
            assert_eq!(leaves, count as usize);
            let least = collapse.least(tree.root(), 1);
            assert!((surfaces - least).abs() < 1e-4 * least, "{surfaces} {least}");
            let greedy = |node| {
                let mut children = vec![node];
                while children.len() < CHILDREN {
                    let area = |node: NodeNumber| tree.aabb(node).half_area();
                    let largest = (0..children.len())
                        .filter(|&place| tree.halves(children[place]).is_some())
                        .max_by(|&a, &b| area(children[a]).total_cmp(&area(children[b])));
                    let Some(place) = largest else { break };
                    let halves = tree.halves(children[place]).unwrap();
                    children[place] = halves[0];
                    children.push(halves[1]);
                }
                children
            };
            let by_size = folded(&tree, &greedy).0;
            println!("{count}: {surfaces} instead of {by_size}");
            assert!(surfaces <= by_size * 1.0001, "{surfaces} {by_size}");
        }
    }
}
