//! Nodes of the bounding volume hierarchy: which of its children a ray reaches, and in which order to visit them.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::records::kernel::*;
    use wgsl_rs::std::*;

    /// Four bytes as numbers, the lowest first.
    pub fn unpack_bytes(word: u32) -> Vec4f {
        vec4f(
            f32(word & 255u32),
            f32((word >> 8u32) & 255u32),
            f32((word >> 16u32) & 255u32),
            f32(word >> 24u32),
        )
    }

    /// Where a ray leaves a box is taken for so much further than computed: rounding must not hide what is on its
    /// surface.
    pub const FURTHER: f32 = 1.0000008;

    /// Edge of a cell from its biased exponent.
    pub fn cell_edge(exponent: u32) -> f32 {
        bitcast_f32(exponent << 23u32)
    }

    /// Which of four boxes a ray reaches before `t_max`, as bits. `near` and `far` are their ends in cells, as the
    /// ray meets them, in x, y and z; `edge` and `start` are the parameters of the ray per cell and at the grid's
    /// corner.
    ///
    /// Conservative: boxes reach further than their objects by more than what rounding loses near the grid, see
    /// `compile::bvh::encode`, and the factor makes up for it far away (Ize, "Robust BVH Ray Traversal", JCGT 2(2),
    /// 2013).
    pub fn reached_of_four(near: Vec3u, far: Vec3u, edge: Vec3f, start: Vec3f, t_max: f32) -> u32 {
        let one = vec4f(1.0, 1.0, 1.0, 1.0);
        let zero = vec4f(0.0, 0.0, 0.0, 0.0);
        let in_x = unpack_bytes(near.x) * edge.x + one * start.x;
        let in_y = unpack_bytes(near.y) * edge.y + one * start.y;
        let in_z = unpack_bytes(near.z) * edge.z + one * start.z;
        let out_x = unpack_bytes(far.x) * edge.x + one * start.x;
        let out_y = unpack_bytes(far.y) * edge.y + one * start.y;
        let out_z = unpack_bytes(far.z) * edge.z + one * start.z;
        let t_in = max(max(in_x, in_y), max(in_z, zero));
        let t_out = min(min(out_x, out_y), min(out_z, one * t_max)) * FURTHER;
        select(0u32, 1u32, t_in.x <= t_out.x)
            | select(0u32, 2u32, t_in.y <= t_out.y)
            | select(0u32, 4u32, t_in.z <= t_out.z)
            | select(0u32, 8u32, t_in.w <= t_out.w)
    }

    /// Children whose boxes a ray reaches before `t_max`, as bits; `inverse` holds the reciprocals of the components
    /// of its direction.
    pub fn reached_boxes(node: BvhNode, origin: Vec3f, inverse: Vec3f, t_max: f32) -> u32 {
        let edge = vec3f(
            cell_edge(node.exponents & 255u32),
            cell_edge((node.exponents >> 8u32) & 255u32),
            cell_edge((node.exponents >> 16u32) & 255u32),
        ) * inverse;
        let start = (node.origin - origin) * inverse;
        let low_x = vec2u(node.low_xy.x, node.low_xy.y);
        let low_y = vec2u(node.low_xy.z, node.low_xy.w);
        let low_z = vec2u(node.low_z_high_x.x, node.low_z_high_x.y);
        let high_x = vec2u(node.low_z_high_x.z, node.low_z_high_x.w);
        let high_y = vec2u(node.high_yz.x, node.high_yz.y);
        let high_z = vec2u(node.high_yz.z, node.high_yz.w);
        let near_x = select(high_x, low_x, inverse.x >= 0.0);
        let near_y = select(high_y, low_y, inverse.y >= 0.0);
        let near_z = select(high_z, low_z, inverse.z >= 0.0);
        let far_x = select(low_x, high_x, inverse.x >= 0.0);
        let far_y = select(low_y, high_y, inverse.y >= 0.0);
        let far_z = select(low_z, high_z, inverse.z >= 0.0);
        let near0 = vec3u(near_x.x, near_y.x, near_z.x);
        let far0 = vec3u(far_x.x, far_y.x, far_z.x);
        let near1 = vec3u(near_x.y, near_y.y, near_z.y);
        let far1 = vec3u(far_x.y, far_y.y, far_z.y);
        reached_of_four(near0, far0, edge, start, t_max)
            | (reached_of_four(near1, far1, edge, start, t_max) << 4u32)
    }

    /// The sides from which a ray comes: bits 1, 2 and 4 for larger x, y and z. The exclusive or with it turns the
    /// number of a child into its place in the order of visits.
    pub fn visiting_order(inverse: Vec3f) -> u32 {
        select(0u32, 1u32, inverse.x < 0.0)
            | select(0u32, 2u32, inverse.y < 0.0)
            | select(0u32, 4u32, inverse.z < 0.0)
    }

    /// Bits of children moved to their places in the order of visits, or back.
    pub fn in_order(children: u32, order: u32) -> u32 {
        let mut bits = children;
        if (order & 1u32) != 0u32 {
            bits = ((bits & 85u32) << 1u32) | ((bits >> 1u32) & 85u32);
        }
        if (order & 2u32) != 0u32 {
            bits = ((bits & 51u32) << 2u32) | ((bits >> 2u32) & 51u32);
        }
        if (order & 4u32) != 0u32 {
            bits = ((bits & 15u32) << 4u32) | (bits >> 4u32);
        }
        bits
    }

    /// How many children, given as bits, stand before one of them.
    pub fn children_before(children: u32, child: u32) -> u32 {
        count_one_bits(children & ((1u32 << child) - 1u32))
    }

    /// Children of a node that are nodes and wait to be visited: the first of all its children that are nodes, and
    /// bits, of which the lowest eight are the waiting ones in the order of visits and the next eight all of them.
    pub fn waiting_children(node: BvhNode, reached: u32, order: u32) -> Vec2u {
        let nodes = node.exponents >> 24u32;
        vec2u(node.first_node, in_order(reached & nodes, order) | (nodes << 8u32))
    }

    /// A single node that waits.
    pub fn waiting_root(root: u32) -> Vec2u {
        vec2u(root, 1u32)
    }

    /// Whether a node waits among some children.
    pub fn any_waits(children: Vec2u) -> bool {
        (children.y & 255u32) != 0u32
    }

    /// The next node to visit.
    pub fn next_node(children: Vec2u, order: u32) -> u32 {
        let child = count_trailing_zeros(children.y) ^ order;
        children.x + children_before(children.y >> 8u32, child)
    }

    /// The children that still wait after the next one.
    pub fn without_next(children: Vec2u) -> Vec2u {
        vec2u(children.x, children.y & (children.y - 1u32))
    }
}
