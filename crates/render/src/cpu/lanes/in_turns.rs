// The search of `kernels::traversal` for the rays of all lanes, one node of each in turn, with the children of a node in
// the lanes of a vector unit.
//
// Rays in large scenes go different ways soon: if every lane searched on its own, most would wait for the others. And a
// ray alone waits for the result of one node before it knows the next. So the rays take turns, which the processor
// overlaps as they do not depend on each other, and objects are tested in lanes as soon as enough rays have met some.
// Every ray visits nodes and objects in the same order as by the kernel, and objects are tested by the same operations,
// so results are the same. (Boxes are larger than what they hold by more than what their test may round differently.)
//
// Large scenes do not fit into the cache: what a ray needs in its next turn is asked for in this one.
//
// This file is included where `kernel`, `unit` and, one module above, `node` are.

use super::super::node::reached_children;
use super::kernel::{self, Found, Globals, Quest, Ray, UniformBuffers};
use super::unit::{F32, LANES, Mask, U32, widen};
use crate::cpu::lanes::nodes::{IN_ORDER, LaneNode, LocalRay, Waiting, fetch_ahead, packed_bits};
use crate::cpu::slices::Slices;
use kernels::bvh::kernel::FURTHER;
use kernels::records::kernel::{NODE_INSTANCE, NONE, SHAPE_INSTANCE, SceneAccess};
use kernels::shape::kernel::{self as shape, transform_ray};
use kernels::traversal::kernel::MAX_BVH_DEPTH;
use lanes::{V3, assign, multiply};
use std::hint::select_unpredictable;
use wgsl_rs::std::vec3f;

/// Places for nodes that wait: one for each level of both hierarchies, and a power of two so that no place needs to be
/// checked.
const STACK: usize = 64;
const _: () = assert!(STACK > 2 * MAX_BVH_DEPTH as usize);

/// Rays with objects to test that are waited for before they are tested together.
const ENOUGH: u32 = LANES as u32 / 2;

/// Where the parts of object records are.
const SHAPE_LINE: usize = 0;
const SURFACE_LINE: usize = 1;

/// The rays of all lanes: memory that is used again for every search.
pub(in super::super) struct Travellers {
    rays: [Traveller; LANES],
    /// The rays in the space of the nodes that are being searched.
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
}

impl Default for Travellers {
    fn default() -> Self {
        let ray = shape::Ray { origin: vec3f(0.0, 0.0, 0.0), direction: vec3f(0.0, 0.0, 1.0) };
        let traveller = Traveller {
            local: LocalRay::new(ray),
            stack: [Waiting { first: 0, bits: 0 }; STACK],
            stacked: 0,
            next: 0,
            leaves_instance: false,
            ended: true,
            instance: NONE,
            outside: usize::MAX,
            outer_order: 0,
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
    /// Node of the next turn, which is taken from the stack already, and whether it is none of the instance any more.
    next: u32,
    leaves_instance: bool,
    /// There is no next node.
    ended: bool,
    /// The instance that is being searched, and how much of the stack belongs to what is outside of it.
    instance: u32,
    outside: usize,
    /// The order of visits outside of instances.
    outer_order: u32,
    /// Objects of the last node that are not tested yet.
    first_object: u32,
    objects: u32,
}

impl Traveller {
    /// Sets out from the root.
    #[inline(always)]
    fn start(&mut self, ray: shape::Ray) {
        self.local = LocalRay::new(ray);
        self.outer_order = self.local.order;
        self.stacked = 0;
        self.next = 0;
        self.leaves_instance = false;
        self.ended = false;
        self.instance = NONE;
        self.outside = usize::MAX;
        self.objects = 0;
    }

    /// Visits the next node; `end` is the parameter of the ray's end times `-FURTHER`. Whether the ray now lives in
    /// another space.
    #[inline(always)]
    fn step<const FEATURES: u32>(
        &mut self,
        scene: Slices<'_, FEATURES>,
        nodes: &[LaneNode],
        outer: impl Fn() -> shape::Ray,
        end: f32,
    ) -> bool {
        let mut moved = false;
        if FEATURES & (1 << SHAPE_INSTANCE) != 0 && self.leaves_instance {
            self.outside = usize::MAX;
            self.instance = NONE;
            self.local = LocalRay::new(outer());
            moved = true;
        }
        let node = &nodes[self.next as usize];
        if FEATURES & (1 << SHAPE_INSTANCE) != 0 && node.nodes == NODE_INSTANCE {
            self.instance = node.first_object;
            self.local = LocalRay::new(transform_ray(
                SceneAccess::shape(scene, self.instance).object_from_world,
                outer(),
            ));
            self.outside = self.stacked;
            self.next = node.first_node;
            self.leaves_instance = false;
            return true;
        }
        let reached = reached_children(node, &self.local, end);
        let in_order =
            u32::from(IN_ORDER[self.local.order as usize % 8][(reached & node.nodes) as usize % 256]);
        self.stack[self.stacked % STACK] =
            Waiting { first: node.first_node, bits: in_order | node.nodes << 8 };
        self.stacked += usize::from(in_order != 0);
        // Without a branch: whether a ray reaches a leaf is hard to foresee, and known late.
        self.first_object = node.first_object;
        self.objects = packed_bits(reached & node.leaves, node.leaves);
        self.choose_next::<FEATURES>(nodes);
        moved
    }

    /// Takes the next node from the stack. Until it is the ray's turn again, the node has time to arrive in the cache.
    #[inline(always)]
    fn choose_next<const FEATURES: u32>(&mut self, nodes: &[LaneNode]) {
        self.ended = self.stacked == 0;
        let mut order = self.local.order;
        if FEATURES & (1 << SHAPE_INSTANCE) != 0 {
            self.leaves_instance = self.stacked == self.outside;
            order = select_unpredictable(self.leaves_instance, self.outer_order, order);
        }
        // If there is none, this is some place that nobody reads.
        let group = &mut self.stack[self.stacked.wrapping_sub(1) % STACK];
        let child = group.bits.trailing_zeros() ^ order;
        let rank = (group.bits >> 8 & (1u32 << (child % 32)).wrapping_sub(1)).count_ones();
        self.next = group.first.wrapping_add(rank);
        group.bits &= group.bits.wrapping_sub(1);
        self.stacked = self.stacked.wrapping_sub(usize::from(group.bits & 255 == 0));
        fetch_ahead(nodes, self.next, 0);
        fetch_ahead(nodes, self.next, 1);
    }

    /// The next object to test.
    #[inline(always)]
    fn next_object(&self) -> u32 {
        self.first_object.wrapping_add(self.objects.trailing_zeros())
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
    let objects = &globals.host.slices.scene().objects;
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
    let end_of = |t: F32| multiply(t, widen(-FURTHER)).to_array();
    let mut end = end_of(found.hit.shape.t);
    let mut waiting = 0u32;
    loop {
        // Without branches that depend on what a ray meets, so that the processor gets far ahead into the next turns.
        while first != end_of_queue && waiting.count_ones() < ENOUGH {
            let i = queue[first % LANES];
            first += 1;
            let traveller = &mut travellers.rays[i % LANES];
            if traveller.step(globals.host.slices, globals.host.nodes, || outer(i), end[i % LANES]) {
                let local = traveller.local.ray;
                for (axis, value) in local.origin.to_array().into_iter().enumerate() {
                    travellers.origin[axis][i] = value;
                }
                for (axis, value) in local.direction.to_array().into_iter().enumerate() {
                    travellers.direction[axis][i] = value;
                }
            }
            let object = select_unpredictable(traveller.objects != 0, traveller.next_object(), 0);
            fetch_ahead(objects, object, SHAPE_LINE);
            let waits = u32::from(traveller.objects != 0);
            let goes_on = usize::from((traveller.objects == 0) & !traveller.ended);
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
            index[i] = traveller.next_object();
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
        end = end_of(found.hit.shape.t);
        let hit = found.hit.object.to_array();
        for i in lanes_of(waiting) {
            let traveller = &travellers.rays[i];
            fetch_ahead(objects, select_unpredictable(hit[i] != NONE, hit[i], 0), SURFACE_LINE);
            let is_light = dark >> i & 1 == 0;
            let waits = is_light & (traveller.objects != 0);
            let goes_on = is_light & (traveller.objects == 0) & !traveller.ended;
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
