// The search of `kernels::traversal` for the rays of all lanes, one node of each in turn, with the children of a node in
// the lanes of a vector unit.
//
// Rays in large scenes go different ways soon: if every lane searched on its own, most would wait for the others. And a
// ray alone waits for the result of one node before it knows the next. So the rays take turns, which the processor
// overlaps as they do not depend on each other, and objects are tested in lanes as soon as enough rays have met some.
// Every ray visits nodes and objects in the same order as by the kernel, and they are tested by the same operations,
// so results are the same.
//
// This file is included where `kernel`, `unit` and, one module above, `node` are.

use super::super::node::reached_children;
use super::kernel::{self, Found, Globals, Quest, Ray, UniformBuffers};
use super::unit::{F32, LANES, Mask, U32, widen};
use crate::cpu::lanes::nodes::{IN_ORDER, LocalRay, Waiting, bytes_in_use, packed_bits};
use crate::cpu::slices::Slices;
use bytemuck::cast_ref;
use kernels::bvh::kernel::leaf_objects;
use kernels::records::kernel::{NODE_INSTANCE, NONE, SHAPE_INSTANCE, SceneAccess};
use kernels::shape::kernel::{self as shape, transform_ray};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use lanes::{V3, assign};
use wgsl_rs::std::vec3f;

/// Places for nodes that wait: one for each level of both hierarchies, and a power of two so that no place needs to be
/// checked.
const STACK: usize = 64;
const _: () = assert!(STACK > 2 * MAX_BVH_DEPTH as usize);

/// Rays with objects to test that are waited for before they are tested together.
const ENOUGH: u32 = LANES as u32 / 2;

/// The rays of all lanes: memory that is used again for every search.
pub(in super::super) struct Travellers {
    rays: [Traveller; LANES],
    /// The rays in the space of the nodes that are being searched.
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
}

impl Default for Travellers {
    fn default() -> Self {
        let nowhere = LocalRay {
            ray: shape::Ray { origin: vec3f(0.0, 0.0, 0.0), direction: vec3f(0.0, 0.0, 0.0) },
            inverse: [0.0; 4],
            origin: [0.0; 4],
            order: 0,
        };
        let traveller = Traveller {
            local: nowhere,
            stack: [Waiting::root(0); STACK],
            stacked: 0,
            instance: NONE,
            outside: usize::MAX,
            first_object: 0,
            objects: 0,
        };
        Travellers { rays: [traveller; LANES], origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3] }
    }
}

/// A ray under way.
#[derive(Clone, Copy)]
struct Traveller {
    local: LocalRay,
    stack: [Waiting; STACK],
    stacked: usize,
    /// The instance that is being searched, and how much of the stack belongs to what is outside of it.
    instance: u32,
    outside: usize,
    /// Objects of the last node that are not tested yet.
    first_object: u32,
    objects: u32,
}

impl Traveller {
    /// Sets out from the root.
    #[inline(always)]
    fn start(&mut self, ray: shape::Ray) {
        self.local = LocalRay::new(ray);
        self.stack[0] = Waiting::root(0);
        self.stacked = 1;
        self.instance = NONE;
        self.outside = usize::MAX;
        self.objects = 0;
    }

    /// Visits the next node. Whether the ray now lives in another space.
    #[inline(always)]
    fn step<const FEATURES: u32>(
        &mut self,
        scene: Slices<'_, FEATURES>,
        outer: impl Fn() -> shape::Ray,
        t_max: f32,
    ) -> bool {
        let mut moved = false;
        if FEATURES & (1 << SHAPE_INSTANCE) != 0 && self.stacked == self.outside {
            self.outside = usize::MAX;
            self.instance = NONE;
            self.local = LocalRay::new(outer());
            moved = true;
        }
        let group = &mut self.stack[(self.stacked - 1) % STACK];
        let child = group.bits.trailing_zeros() ^ self.local.order;
        let index = group.first + ((group.bits >> 8) & ((1 << child) - 1)).count_ones();
        group.bits &= group.bits - 1;
        self.stacked -= usize::from(group.bits & 255 == 0);
        let node = &scene.scene().nodes[index as usize];
        if FEATURES & (1 << SHAPE_INSTANCE) != 0 && node.exponents == NODE_INSTANCE {
            self.instance = node.first_object;
            self.local = LocalRay::new(transform_ray(
                SceneAccess::shape(scene, self.instance).object_from_world,
                outer(),
            ));
            self.outside = self.stacked;
            self.stack[self.stacked % STACK] = Waiting::root(node.first_node);
            self.stacked += 1;
            return true;
        }
        let words: &[u32; 20] = cast_ref(node);
        let reached = reached_children(words, self.local.origin, self.local.inverse, t_max);
        let nodes = node.exponents >> 24;
        let in_order = u32::from(IN_ORDER[self.local.order as usize % 8][(reached & nodes) as usize]);
        self.stack[self.stacked % STACK] = Waiting { first: node.first_node, bits: in_order | nodes << 8 };
        self.stacked += usize::from(in_order != 0);
        // Without a branch: whether a ray reaches a leaf is hard to foresee, and known late.
        let leaves = reached & !nodes;
        self.first_object = node.first_object;
        self.objects = if scene.leaves_are_single() {
            let leaf_bytes = u64::from(node.leaves0) | u64::from(node.leaves1) << 32;
            packed_bits(leaves, bytes_in_use(leaf_bytes))
        } else {
            leaf_objects(*node, leaves)
        };
        moved
    }
}

/// Looks for what the rays of some lanes meet up to parameter `t_max`, as `kernels::traversal::search`.
///
/// It is called by kernels alone, which need the vector unit themselves.
#[inline(always)]
pub(super) fn search(
    globals: &Globals<'_>,
    live: Mask,
    scene: UniformBuffers,
    ray: Ray,
    t_max: F32,
    quest: Quest,
) -> Found {
    // SAFETY of both calls: whoever called has asked for the features that the kernels are compiled for.
    let meet = |mask, instance, index, ray, found| unsafe {
        kernel::meet_object_Buffers(globals, mask, scene, instance, index, ray, quest, found)
    };
    let is_dark = |mask, passed| unsafe { kernel::is_dark(globals, mask, passed) };
    let header = &globals.HEADER;
    let none = widen(NONE);
    let mut found = Found {
        hit: kernel::Hit {
            shape: kernel::ShapeHit { t: t_max, face: widen(0u32) },
            object: none,
            instance: none,
        },
        passed: widen(V3 { x: 1.0, y: 1.0, z: 1.0 }),
    };
    let mut starting = live;
    for index in 0..header.unbounded_objects {
        let met = meet(starting, none, widen(index), ray, found);
        assign(starting, &mut found, met);
        starting = starting.without(is_dark(starting, found.passed));
    }
    if header.nodes == 0 {
        return found;
    }
    let three = |v: V3<F32>| [v.x.to_array(), v.y.to_array(), v.z.to_array()];
    let (origin, direction) = (three(ray.origin), three(ray.direction));
    let outer = |i: usize| shape::Ray {
        origin: vec3f(origin[0][i], origin[1][i], origin[2][i]),
        direction: vec3f(direction[0][i], direction[1][i], direction[2][i]),
    };
    let travellers = &mut *globals.host.workspace.borrow_mut();
    (travellers.origin, travellers.direction) = (origin, direction);
    // Rays that can visit a node, in the order of their turns, as a ring; and those that have met objects.
    let mut queue = [0usize; LANES];
    let (mut first, mut end_of_queue) = (0, 0);
    for i in lanes_of(starting.bits()) {
        travellers.rays[i].start(outer(i));
        queue[end_of_queue % LANES] = i;
        end_of_queue += 1;
    }
    let mut end = found.hit.shape.t.to_array();
    let mut waiting = 0u32;
    loop {
        // Without branches that depend on what a ray meets, so that the processor gets far ahead into the next turns.
        while first != end_of_queue && waiting.count_ones() < ENOUGH {
            let i = queue[first % LANES];
            first += 1;
            let traveller = &mut travellers.rays[i % LANES];
            if traveller.step(globals.host.slices, || outer(i), end[i % LANES]) {
                let local = traveller.local.ray;
                for (axis, value) in local.origin.to_array().into_iter().enumerate() {
                    travellers.origin[axis][i] = value;
                }
                for (axis, value) in local.direction.to_array().into_iter().enumerate() {
                    travellers.direction[axis][i] = value;
                }
            }
            let waits = u32::from(traveller.objects != 0);
            let goes_on = usize::from((traveller.objects == 0) & (traveller.stacked != 0));
            waiting |= waits << i;
            queue[end_of_queue % LANES] = i;
            end_of_queue += goes_on;
        }
        if waiting == 0 {
            return found;
        }
        let [mut index, mut instance] = [[0; LANES]; 2];
        for i in lanes_of(waiting) {
            let traveller = &mut travellers.rays[i];
            index[i] = traveller.first_object + traveller.objects.trailing_zeros();
            traveller.objects &= traveller.objects - 1;
            instance[i] = traveller.instance;
        }
        let mask = Mask::from_bits(waiting);
        let vector = |v: [[f32; LANES]; 3]| {
            let [x, y, z] = v.map(F32::from_array);
            V3 { x, y, z }
        };
        let local = Ray { origin: vector(travellers.origin), direction: vector(travellers.direction) };
        let met = meet(mask, U32::from_array(instance), U32::from_array(index), local, found);
        assign(mask, &mut found, met);
        let dark = is_dark(mask, found.passed).bits();
        end = found.hit.shape.t.to_array();
        for i in lanes_of(waiting) {
            let traveller = &travellers.rays[i];
            let is_light = dark >> i & 1 == 0;
            let waits = is_light & (traveller.objects != 0);
            let goes_on = is_light & (traveller.objects == 0) & (traveller.stacked != 0);
            waiting = waiting & !(1 << i) | u32::from(waits) << i;
            queue[end_of_queue % LANES] = i;
            end_of_queue += usize::from(goes_on);
        }
    }
}

/// The numbers of the lanes whose bits are set.
#[inline(always)]
fn lanes_of(bits: u32) -> impl Iterator<Item = usize> {
    let mut rest = bits;
    std::iter::from_fn(move || {
        let lane = rest.trailing_zeros() as usize % LANES;
        let some = rest != 0;
        rest &= rest.wrapping_sub(1);
        some.then_some(lane)
    })
}
