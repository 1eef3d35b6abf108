// The search of `kernels::traversal` for some groups of rays, one node of each ray in turn, with the children of a node in
// the lanes of a vector unit.
//
// Rays in large scenes go different ways soon: if every lane searched on its own, most would wait for the others. And a
// ray alone waits for the result of one node before it knows the next. So the rays take turns, which the processor
// overlaps as they do not depend on each other, and objects are tested in lanes as soon as enough rays of a group have met
// some: meanwhile the others go on.
// Every ray visits nodes and objects in the same order as by the kernel, and objects are tested by the same operations,
// so results are the same. (Boxes are larger than what they hold by more than what their test may round differently.)
//
// Large scenes do not fit into the cache: what a ray needs in its next turn is asked for in this one.
//
// This file is included where `kernel`, `unit` and, one module above, `node` are.

use super::super::node::reached_children;
use super::kernel::{self, Found, Globals, Ray, RayQuery, UniformBuffers};
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

/// Groups of rays, one in each lane, that are searched for together.
pub(super) const GROUPS: usize = 3;
const RAYS: usize = LANES * GROUPS;

/// Rays of a group with objects to test that are waited for before they are tested together.
const ENOUGH: u32 = LANES as u32 * 7 / 8;

/// Where the parts of object records are.
const SHAPE_LINE: usize = 0;
const SURFACE_LINE: usize = 1;

/// The rays of all groups: memory that is used again for every search.
pub(super) struct Travellers {
    rays: [Traveller; RAYS],
    /// The rays of each group in the space of the nodes that are being searched.
    local: [RayComponents; GROUPS],
}

/// Origins and directions of the rays of a group, in x, y and z.
#[derive(Clone, Copy, Default)]
struct RayComponents {
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
}

impl RayComponents {
    #[inline(always)]
    fn of(ray: Ray) -> Self {
        let three = |v: V3<F32>| [v.x.to_array(), v.y.to_array(), v.z.to_array()];
        RayComponents { origin: three(ray.origin), direction: three(ray.direction) }
    }

    #[inline(always)]
    fn to_lanes(self) -> Ray {
        let vector = |v: [[f32; LANES]; 3]| {
            let [x, y, z] = v.map(F32::from_array);
            V3 { x, y, z }
        };
        Ray { origin: vector(self.origin), direction: vector(self.direction) }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> shape::Ray {
        let three = |v: &[[f32; LANES]; 3]| vec3f(v[0][lane], v[1][lane], v[2][lane]);
        shape::Ray { origin: three(&self.origin), direction: three(&self.direction) }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, ray: shape::Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin.to_array()[axis];
            self.direction[axis][lane] = ray.direction.to_array()[axis];
        }
    }
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
        Travellers { rays: [traveller; RAYS], local: Default::default() }
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

    /// Comes out of the instance that was searched, or into the one that the next node stands for, if any. Whether the ray
    /// lives in another space now.
    #[inline(always)]
    fn change_space(
        &mut self,
        scene: Slices<'_, { super::FEATURES }>,
        nodes: &[LaneNode],
        outer: impl Fn() -> shape::Ray,
    ) -> bool {
        let mut changes = false;
        if self.leaves_instance {
            self.outside = usize::MAX;
            self.instance = NONE;
            self.leaves_instance = false;
            self.local = LocalRay::new(outer());
            changes = true;
        }
        let node = &nodes[self.next as usize];
        if node.nodes == NODE_INSTANCE {
            self.instance = node.first_object;
            let object_from_world = SceneAccess::shape(scene, self.instance).object_from_world;
            self.local = LocalRay::new(transform_ray(object_from_world, outer()));
            self.outside = self.stacked;
            self.next = node.first_node;
            changes = true;
        }
        changes
    }

    /// Takes what was reached and chooses the next node: among the children of the last one, if there are any, or those on
    /// the stack. Until it is the ray's turn again, the node has time to arrive in the cache.
    #[inline(always)]
    fn go_on<const INSTANCES: bool>(&mut self, nodes: &[LaneNode], in_order: u8, objects: u32) {
        let node = &nodes[self.next as usize];
        let children = Waiting { first: node.first_node, bits: u32::from(in_order) | node.nodes << 8 };
        // Without a branch: whether a ray reaches a leaf is hard to foresee, and known late.
        (self.first_object, self.objects) = (node.first_object, objects);
        let goes_down = children.bits & 255 != 0;
        // If there are none, this is some place that nobody reads.
        let place = self.stacked.wrapping_sub(usize::from(!goes_down));
        let above = self.stack[self.stacked.wrapping_sub(1) % STACK];
        let first = select_unpredictable(goes_down, children.first, above.first);
        let bits = select_unpredictable(goes_down, children.bits, above.bits);
        self.ended = !goes_down & (self.stacked == 0);
        let mut order = self.local.order;
        if INSTANCES {
            self.leaves_instance = !goes_down & (self.stacked == self.outside);
            order = select_unpredictable(self.leaves_instance, self.outer_order, order);
        }
        let child = bits.trailing_zeros() ^ order;
        let rank = (bits >> 8 & (1u32 << (child % 32)).wrapping_sub(1)).count_ones();
        self.next = first.wrapping_add(rank);
        fetch_ahead(nodes, self.next, 0);
        fetch_ahead(nodes, self.next, 1);
        let bits = bits & bits.wrapping_sub(1);
        self.stack[place % STACK] = Waiting { first, bits };
        self.stacked = place.wrapping_add(usize::from(bits & 255 != 0));
    }

    /// The next object to test.
    #[inline(always)]
    fn next_object(&self) -> u32 {
        self.first_object.wrapping_add(self.objects.trailing_zeros())
    }
}

/// What a group of rays asks, and which of its lanes do.
#[derive(Clone, Copy)]
pub(super) struct GroupQuery {
    pub(super) live: Mask,
    pub(super) query: RayQuery,
}

/// Looks for what the rays of some groups meet, as `kernels::traversal::search`.
///
/// # Safety
/// The processor must have what the kernels are compiled for.
#[inline(always)]
pub(super) unsafe fn search(
    globals: &Globals<'_>,
    slices: Slices<'_, { super::FEATURES }>,
    nodes: &[LaneNode],
    travellers: &mut Travellers,
    queries: &[GroupQuery; GROUPS],
) -> [Found; GROUPS] {
    // SAFETY of both calls: the caller's promise.
    if slices.scene().features & (1 << SHAPE_INSTANCE) != 0 {
        unsafe { search_with::<true>(globals, slices, nodes, travellers, queries) }
    } else {
        unsafe { search_with::<false>(globals, slices, nodes, travellers, queries) }
    }
}

/// The same for scenes with instances or without.
///
/// # Safety
/// The processor must have what the kernels are compiled for.
#[inline(always)]
unsafe fn search_with<const INSTANCES: bool>(
    globals: &Globals<'_>,
    slices: Slices<'_, { super::FEATURES }>,
    nodes: &[LaneNode],
    travellers: &mut Travellers,
    queries: &[GroupQuery; GROUPS],
) -> [Found; GROUPS] {
    let scene = UniformBuffers { unused: 0 };
    // SAFETY of both calls: the caller's promise.
    let meet = |mask, instance, index, ray, group: usize, found| unsafe {
        let quest = queries[group].query.quest;
        kernel::meet_object_Buffers(globals, mask, scene, instance, index, ray, quest, found)
    };
    let is_dark = |mask, passed| unsafe { kernel::is_dark(globals, mask, passed) };
    let header = &globals.HEADER;
    let objects = &slices.scene().objects;
    let none = widen(NONE);
    let nothing = |query: &GroupQuery| Found {
        hit: kernel::Hit {
            shape: kernel::ShapeHit { t: query.query.t_max, face: widen(0u32) },
            object: none,
            instance: none,
        },
        passed: widen(V3 { x: 1.0, y: 1.0, z: 1.0 }),
    };
    let mut found = queries.each_ref().map(nothing);
    let mut outer = [RayComponents::default(); GROUPS];
    let mut end = [0.0; RAYS];
    let end_of = |t: F32| multiply(t, widen(-FURTHER)).to_array();
    // Rays that can visit a node, in the order of their turns; and those that have met objects, as bits.
    let mut queue = Queue { rays: [0; RAYS], first: 0, end: 0 };
    let mut waiting = 0u64;
    for group in 0..GROUPS {
        let GroupQuery { live, query } = queries[group];
        let mut starting = live;
        let found = &mut found[group];
        for index in 0..header.unbounded_objects {
            let met = meet(starting, none, widen(index), query.ray, group, *found);
            assign(starting, found, met);
            starting = starting.without(is_dark(starting, found.passed));
        }
        outer[group] = RayComponents::of(query.ray);
        end[group * LANES..][..LANES].copy_from_slice(&end_of(found.hit.shape.t));
        if header.nodes != 0 {
            for lane in lanes_of(starting.bits()) {
                travellers.rays[group * LANES + lane].start(outer[group].get(lane));
                queue.push(group * LANES + lane, true);
            }
        }
    }
    travellers.local = outer;
    let waiting_of = |waiting: u64, group: usize| Mask::from_bits((waiting >> (group * LANES)) as u32).bits();
    let is_full = |waiting: u64| (0..GROUPS).any(|group| waiting_of(waiting, group).count_ones() >= ENOUGH);
    let turns = Turns { slices, nodes, outer: &outer };
    loop {
        while queue.len() >= AT_ONCE && !is_full(waiting) {
            waiting |= turns.take::<AT_ONCE, INSTANCES>(travellers, &mut queue, &end);
        }
        // Few rays alone get slowly ahead: better bring some back that wait for a test.
        while !queue.is_empty() && waiting == 0 {
            if queue.len() >= AT_ONCE / 2 {
                waiting |= turns.take::<{ AT_ONCE / 2 }, INSTANCES>(travellers, &mut queue, &end);
            } else {
                waiting |= turns.take::<1, INSTANCES>(travellers, &mut queue, &end);
            }
        }
        let count = |group: &usize| waiting_of(waiting, *group).count_ones();
        let group = (0..GROUPS).max_by_key(count).unwrap_or(0);
        let members = waiting_of(waiting, group);
        if members == 0 {
            return found;
        }
        let rays = &mut travellers.rays[group * LANES..][..LANES];
        let [mut index, mut instance] = [[0; LANES]; 2];
        for lane in lanes_of(members) {
            let traveller = &mut rays[lane];
            index[lane] = traveller.next_object();
            traveller.objects &= traveller.objects - 1;
            instance[lane] = traveller.instance;
        }
        let mask = Mask::from_bits(members);
        let local = travellers.local[group].to_lanes();
        let found = &mut found[group];
        let met = meet(mask, U32::from_array(instance), U32::from_array(index), local, group, *found);
        assign(mask, found, met);
        let dark = is_dark(mask, found.passed).bits();
        end[group * LANES..][..LANES].copy_from_slice(&end_of(found.hit.shape.t));
        let hit = found.hit.object.to_array();
        for lane in lanes_of(members) {
            let i = group * LANES + lane;
            let traveller = &rays[lane];
            fetch_ahead(objects, select_unpredictable(hit[lane] != NONE, hit[lane], 0), SURFACE_LINE);
            let is_light = dark >> lane & 1 == 0;
            let waits = is_light & (traveller.objects != 0);
            let goes_on = is_light & (traveller.objects == 0) & !traveller.ended;
            waiting = waiting & !(1 << i) | u64::from(waits) << i;
            queue.push(i, goes_on);
        }
    }
}

/// Rays in the order of their turns, as a ring.
struct Queue {
    rays: [u8; RAYS],
    first: usize,
    end: usize,
}

impl Queue {
    #[inline(always)]
    fn len(&self) -> usize {
        self.end - self.first
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends a ray, if it takes part at all.
    #[inline(always)]
    fn push(&mut self, ray: usize, takes_part: bool) {
        self.rays[self.end % RAYS] = ray as u8;
        self.end += usize::from(takes_part);
    }

    /// Takes so many rays, which there must be.
    #[inline(always)]
    fn take<const N: usize>(&mut self) -> [usize; N] {
        let mut rays = [0; N];
        for (k, ray) in rays.iter_mut().enumerate() {
            *ray = usize::from(self.rays[(self.first + k) % RAYS]) % RAYS;
        }
        self.first += N;
        rays
    }
}

/// Turns that are taken at once: the steps of one wait for each other, those of several rays do not.
const AT_ONCE: usize = 4;

/// What rays need for their turns.
struct Turns<'a> {
    slices: Slices<'a, { super::FEATURES }>,
    nodes: &'a [LaneNode],
    /// The rays outside of instances.
    outer: &'a [RayComponents; GROUPS],
}

impl Turns<'_> {
    /// The next rays visit a node each, without branches that depend on what they meet. Returns those that have met
    /// objects, as bits.
    #[inline(always)]
    fn take<const N: usize, const INSTANCES: bool>(
        &self,
        travellers: &mut Travellers,
        queue: &mut Queue,
        end: &[f32; RAYS],
    ) -> u64 {
        let members = queue.take::<N>();
        if INSTANCES {
            for i in members {
                let (group, lane) = (i / LANES, i % LANES);
                let traveller = &mut travellers.rays[i];
                if traveller.change_space(self.slices, self.nodes, || self.outer[group].get(lane)) {
                    travellers.local[group].set(lane, traveller.local.ray);
                }
            }
        }
        let mut visited = [&self.nodes[0]; N];
        let mut rays = [&travellers.rays[0].local; N];
        let mut ends = [0.0; N];
        for k in 0..N {
            let traveller = &travellers.rays[members[k]];
            visited[k] = &self.nodes[traveller.next as usize];
            rays[k] = &traveller.local;
            ends[k] = end[members[k]];
        }
        let reached = reached_children(visited, rays, ends);
        let mut in_order = [0; N];
        let mut objects = [0; N];
        for k in 0..N {
            let node = visited[k];
            in_order[k] = IN_ORDER[rays[k].order as usize % 8][(reached[k] & node.nodes) as usize % 256];
            objects[k] = packed_bits(reached[k] & node.leaves, node.leaves);
        }
        let mut waiting = 0;
        for k in 0..N {
            let i = members[k];
            let traveller = &mut travellers.rays[i];
            traveller.go_on::<INSTANCES>(self.nodes, in_order[k], objects[k]);
            let waits = traveller.objects != 0;
            let object = select_unpredictable(waits, traveller.next_object(), 0);
            fetch_ahead(&self.slices.scene().objects, object, SHAPE_LINE);
            waiting |= u64::from(waits) << i;
            queue.push(i, !waits & !traveller.ended);
        }
        waiting
    }
}

/// The numbers of the lanes whose bits are set.
#[inline(always)]
pub(super) fn lanes_of(bits: u32) -> impl Iterator<Item = usize> {
    let mut rest = bits;
    std::iter::from_fn(move || {
        let lane = rest.trailing_zeros() as usize % LANES;
        let some = rest != 0;
        rest &= rest.wrapping_sub(1);
        some.then_some(lane)
    })
}
