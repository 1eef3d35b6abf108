//! The objects of a scene as records: those that stand for themselves, groups, and their instances.

use super::instances::{Placement, stays_in_group};
use super::materials::Materials;
use super::triangles::placed_triangles;
use super::unit_shapes::{UnitShape, object_from_unit, unit_bounds, unit_shape};
use super::{Acceleration, CompileError, affine, count};
use kernels::records::kernel::{
    FLAG_NOT_OPAQUE, NONE, ObjectRecord, SHAPE_INSTANCE, ShapeRecord, SurfaceRecord,
};
use scene::{DAffine3, DVec3, MeshId, Object, Origin, Scene, Shape, VisibleSides};
use std::collections::HashMap;

/// Objects as records with their boxes.
#[derive(Default)]
pub(super) struct Primitives {
    pub unbounded: Vec<ObjectRecord>,
    pub bounded: Vec<ObjectRecord>,
    /// Box of every bounded object as (minimum, maximum), in the same order.
    pub boxes: Vec<(DVec3, DVec3)>,
    pub instances: Vec<PlacedGroup>,
}

/// An instance of a compiled group.
pub(super) struct PlacedGroup {
    /// With the number of the group in the field `material`.
    pub record: ObjectRecord,
    /// Where the records of the group stand.
    pub local_from_group: DAffine3,
}

impl PlacedGroup {
    /// Number of the group among the compiled ones.
    pub fn group(&self) -> usize {
        self.record.shape.material as usize
    }
}

/// All objects of a scene.
pub(super) struct Objects {
    /// Those that stand for themselves, and the instances.
    pub scene: Primitives,
    /// Members of the groups that instances refer to, at least two in each and none of them an instance.
    pub groups: Vec<Primitives>,
    /// Table of the attributes of triangles, and of the frames of objects whose materials look at the position.
    pub attributes: Vec<[f32; 4]>,
    /// What objects and instances come from, by `SurfaceRecord::source`.
    pub origins: Vec<Origin>,
    /// Number of triangles of all meshes, counted as often as they are drawn.
    pub triangles: usize,
}

/// A mesh that is drawn several times with one material becomes a group if it has more triangles than this; smaller
/// ones are cheaper as copies.
const FEW_TRIANGLES: usize = 8;

/// What a mesh looks like wherever it is placed; the last is the record of its material.
type MeshKey = (MeshId, VisibleSides, u32);

/// Compiles the objects of a scene; lamps, lights and planes of groups are among its own objects already.
pub(super) fn compile_objects(
    scene: &Scene,
    placements: &[Placement],
    local_from_world: &DAffine3,
    materials: &Materials,
    light_of_object: &[u32],
    acceleration: Acceleration,
) -> Result<Objects, CompileError> {
    let mut compiler = Compiler {
        scene,
        materials,
        instancing: acceleration == Acceleration::Bvh,
        mesh_groups: HashMap::new(),
        group_facts: Vec::new(),
        objects: Objects {
            scene: Primitives::default(),
            groups: Vec::new(),
            attributes: Vec::new(),
            origins: Vec::new(),
            triangles: 0,
        },
    };
    let group_of = compiler.compile_groups(placements)?;
    let is_copied = |placement: &&Placement| group_of[placement.group].is_none();
    compiler.find_repeated_meshes(placements.iter().filter(is_copied))?;

    let mut level = Primitives::default();
    for (index, object) in scene.objects.iter().enumerate() {
        let source = compiler.add_origin(object.origin);
        let light = light_of_object.get(index).copied().unwrap_or(NONE);
        let local_from_object = *local_from_world * object.world_from_object;
        compiler.add(&mut level, object, &local_from_object, source, light)?;
    }
    for placement in placements {
        let local_from_group = *local_from_world * placement.world_from_group;
        if let Some(group) = group_of[placement.group] {
            let source = compiler.add_origin(placement.origin);
            compiler.add_instance(&mut level, group, &local_from_group, source)?;
            continue;
        }
        for object in scene.groups[placement.group].objects.iter().filter(|object| stays_in_group(object)) {
            let source = compiler.add_origin(object.origin);
            compiler.add(&mut level, object, &(local_from_group * object.world_from_object), source, NONE)?;
        }
    }
    compiler.objects.scene = level;
    Ok(compiler.objects)
}

struct Compiler<'a> {
    scene: &'a Scene,
    materials: &'a Materials,
    /// Whether repeated geometry is stored once.
    instancing: bool,
    /// Groups that are made of meshes.
    mesh_groups: HashMap<MeshKey, usize>,
    /// Of every compiled group.
    group_facts: Vec<GroupFacts>,
    objects: Objects,
}

/// What instances need to know of their group, found out once: groups may have many members, and many instances.
#[derive(Clone, Copy)]
struct GroupFacts {
    /// Its middle: its records are relative to it, so that their numbers are small.
    centre: DVec3,
    /// Flags that some member has.
    flags: u32,
}

impl Compiler<'_> {
    fn mesh_key(&self, object: &Object) -> Option<MeshKey> {
        match object.shape {
            Shape::Mesh { mesh, visible_sides } => {
                Some((mesh, visible_sides, self.materials.record(object.material, object.interior)))
            }
            _ => None,
        }
    }

    fn add_origin(&mut self, origin: Origin) -> u32 {
        self.objects.origins.push(origin);
        count(self.objects.origins.len() - 1)
    }

    /// Compiles the groups that are worth it. For every group of the scene its number among the compiled ones;
    /// the members of the others are copied to every place.
    fn compile_groups(&mut self, placements: &[Placement]) -> Result<Vec<Option<usize>>, CompileError> {
        let mut uses = vec![0usize; self.scene.groups.len()];
        for placement in placements {
            uses[placement.group] += 1;
        }
        let mut numbers = vec![None; uses.len()];
        for (index, group) in self.scene.groups.iter().enumerate() {
            if uses[index] < 2 || !self.instancing {
                continue;
            }
            let members: Vec<&Object> =
                group.objects.iter().filter(|object| stays_in_group(object)).collect();
            if members.len() < 2 && !members.iter().any(|object| matches!(object.shape, Shape::Mesh { .. })) {
                continue;
            }
            let bounds = members.iter().filter_map(|object| object.bounds(&self.scene.meshes));
            let bounds = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
            let centre = bounds.map_or(DVec3::ZERO, |(low, high)| 0.5 * (low + high));
            let mut level = Primitives::default();
            for object in members {
                let source = self.add_origin(object.origin);
                let placed = DAffine3::from_translation(-centre) * object.world_from_object;
                self.add(&mut level, object, &placed, source, NONE)?;
            }
            numbers[index] = self.keep_group(level, centre);
        }
        Ok(numbers)
    }

    /// Keeps a group if it has the two members that the root of a hierarchy needs.
    fn keep_group(&mut self, level: Primitives, centre: DVec3) -> Option<usize> {
        if level.bounded.len() < 2 {
            return None;
        }
        let flags = level.bounded.iter().fold(0, |all, object| all | object.shape.kind) & FLAG_NOT_OPAQUE;
        self.objects.groups.push(level);
        self.group_facts.push(GroupFacts { centre, flags });
        Some(self.objects.groups.len() - 1)
    }

    /// Makes groups of the meshes that are drawn several times outside groups.
    fn find_repeated_meshes<'b>(
        &mut self,
        copied: impl Iterator<Item = &'b Placement>,
    ) -> Result<(), CompileError> {
        if !self.instancing {
            return Ok(());
        }
        let scene = self.scene;
        let mut uses: HashMap<MeshKey, usize> = HashMap::new();
        let of_groups = copied.flat_map(|placement| &scene.groups[placement.group].objects);
        for key in scene.objects.iter().chain(of_groups).filter_map(|object| self.mesh_key(object)) {
            *uses.entry(key).or_default() += 1;
        }
        // In the order of the scene, so that the same scene always gives the same tables.
        let mut repeated: Vec<MeshKey> =
            uses.into_iter().filter(|(_, n)| *n > 1).map(|(key, _)| key).collect();
        repeated.sort_unstable();
        for (id, visible_sides, material) in repeated {
            let mesh = &scene.meshes[id.index()];
            if mesh.triangles.len() <= FEW_TRIANGLES {
                continue;
            }
            let Some((low, high)) = mesh.bounds(&DAffine3::IDENTITY) else { continue };
            let centre = 0.5 * (low + high);
            let mut level = Primitives::default();
            let place = DAffine3::from_translation(-centre);
            // The triangles come from what the instance comes from.
            self.add_triangles(&mut level, (id, visible_sides, material), &place, NONE)?;
            if let Some(group) = self.keep_group(level, centre) {
                self.mesh_groups.insert((id, visible_sides, material), group);
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        level: &mut Primitives,
        object: &Object,
        local_from_object: &DAffine3,
        source: u32,
        light: u32,
    ) -> Result<(), CompileError> {
        if let Some(key) = self.mesh_key(object) {
            self.objects.triangles += self.scene.meshes[key.0.index()].triangles.len();
            if let Some(&group) = self.mesh_groups.get(&key) {
                return self.add_instance(level, group, local_from_object, source);
            }
            return self.add_triangles(level, key, local_from_object, source);
        }
        let mut unit = unit_shape(object, local_from_object);
        let material = self.materials.record(object.material, object.interior);
        if self.materials.uses_position(material) {
            unit.attributes = count(self.objects.attributes.len());
            self.objects.attributes.extend(object_from_unit(&unit, local_from_object));
        }
        self.add_unit(level, &unit, material, source, light)
    }

    fn add_triangles(
        &mut self,
        level: &mut Primitives,
        (id, visible_sides, material): MeshKey,
        local_from_object: &DAffine3,
        source: u32,
    ) -> Result<(), CompileError> {
        let mesh = &self.scene.meshes[id.index()];
        let mut attributes = std::mem::take(&mut self.objects.attributes);
        let position = self.materials.uses_position(material);
        for triangle in placed_triangles(mesh, visible_sides, local_from_object, position, &mut attributes) {
            self.add_unit(level, &triangle, material, source, NONE)?;
        }
        self.objects.attributes = attributes;
        Ok(())
    }

    /// Adds a compiled group as one object.
    fn add_instance(
        &mut self,
        level: &mut Primitives,
        group: usize,
        local_from_group: &DAffine3,
        source: u32,
    ) -> Result<(), CompileError> {
        let GroupFacts { centre, flags } = self.group_facts[group];
        let unit = UnitShape {
            kind: SHAPE_INSTANCE,
            local_from_unit: *local_from_group * DAffine3::from_translation(centre),
            base_radius: 1.0,
            top_radius: 1.0,
            v_scale: 1.0,
            attributes: NONE,
        };
        let record = self.record(&unit, count(group), flags, source, NONE)?;
        level.instances.push(PlacedGroup { record, local_from_group: unit.local_from_unit });
        Ok(())
    }

    fn add_unit(
        &self,
        level: &mut Primitives,
        unit: &UnitShape,
        material: u32,
        source: u32,
        light: u32,
    ) -> Result<(), CompileError> {
        let flags = if self.materials.is_not_opaque(material) { FLAG_NOT_OPAQUE } else { 0 };
        let record = self.record(unit, material, flags, source, light)?;
        match unit_bounds(unit) {
            Some(bounds) => {
                level.bounded.push(record);
                level.boxes.push(bounds);
            }
            None => level.unbounded.push(record),
        }
        Ok(())
    }

    fn record(
        &self,
        unit: &UnitShape,
        material: u32,
        flags: u32,
        source: u32,
        light: u32,
    ) -> Result<ObjectRecord, CompileError> {
        let unit_from_local = unit.local_from_unit.inverse();
        let determinant = unit.local_from_unit.matrix3.determinant();
        if determinant == 0.0 || !determinant.is_finite() || !unit_from_local.is_finite() {
            let origin = self.objects.origins.get(source as usize);
            let name = origin.and_then(|origin| self.scene.type_names.get(origin.type_name.index()));
            return Err(CompileError::DegenerateObject {
                type_name: name.cloned().unwrap_or_default(),
                node: origin.map_or(0, |origin| origin.node),
            });
        }
        Ok(ObjectRecord {
            shape: ShapeRecord {
                object_from_world: affine(&unit_from_local),
                kind: unit.kind | flags,
                material,
                base_radius: unit.base_radius as f32,
                top_radius: unit.top_radius as f32,
            },
            surface: SurfaceRecord {
                world_from_object: affine(&unit.local_from_unit),
                v_scale: unit.v_scale as f32,
                light,
                source,
                attributes: unit.attributes,
            },
        })
    }
}
