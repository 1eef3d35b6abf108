//! Triangle meshes: `PolygonMesh` objects that the graph holds as Java streams (scene-format.md 2.7 and 4.3).

use crate::ReadError;
use crate::fields::{Field, Fields};
use crate::java_stream::{self, JavaObject, JavaValue};
use crate::shapes::Geometry;
use crate::values::Kind;
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use glam::DAffine3;
use scene::{Mesh, MeshId, Scene, Shape, VisibleSides};
use std::collections::HashMap;
use std::sync::Arc;

/// Accepts payloads with and without `=` at the end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Meshes by their payload, so that a plant with a thousand equal leaves stores one.
#[derive(Default)]
pub(crate) struct Meshes {
    by_payload: HashMap<String, Result<MeshId, String>>,
}

impl Meshes {
    /// The mesh of a MeshNode; the inner error says why there is none to draw.
    pub fn geometry(
        &mut self,
        fields: &Fields<'_>,
        scene: &mut Scene,
    ) -> Result<Result<Geometry, String>, ReadError> {
        let visible_sides = visible_sides(fields)?;
        let payload = match fields.get("polygons") {
            Field::File(value) if value.kind == Kind::Serialized => value.text(),
            Field::File(value) if value.kind == Kind::Null => {
                return Ok(Err("it has no polygons".to_owned()));
            }
            Field::File(_) => return Ok(Err("its kind of polygons is not supported yet".to_owned())),
            Field::Module(_) | Field::Missing => return Ok(Err("it has no polygons".to_owned())),
        };
        let mesh = match self.by_payload.get(payload) {
            Some(known) => known.clone(),
            None => {
                let mesh = match decode(payload) {
                    Ok(mesh) if mesh.triangles.is_empty() => Err("it has no polygons".to_owned()),
                    Ok(mesh) => Ok(scene.add_mesh(mesh)),
                    Err(problem) => Err(format!("its polygons cannot be read: {problem}")),
                };
                self.by_payload.insert(payload.to_owned(), mesh.clone());
                mesh
            }
        };
        Ok(mesh.map(|mesh| Geometry {
            shape: Shape::Mesh { mesh, visible_sides },
            own_from_object: DAffine3::IDENTITY,
        }))
    }
}

/// The field `visibleSides` of meshes and surfaces.
pub(crate) fn visible_sides(fields: &Fields<'_>) -> Result<VisibleSides, ReadError> {
    Ok(match fields.number("visibleSides", 2.0)? as i64 {
        0 => VisibleSides::Front,
        1 => VisibleSides::Back,
        _ => VisibleSides::Both,
    })
}

fn decode(payload: &str) -> Result<Mesh, String> {
    let text: String = payload.split_ascii_whitespace().collect();
    let bytes = BASE64.decode(text).map_err(|error| format!("not base64 ({error})"))?;
    polygon_mesh(&java_stream::parse(&bytes)?)
}

/// The mesh in an object with the fields of a `PolygonMesh`; other classes are welcome to have them too.
pub(crate) fn polygon_mesh(object: &JavaObject) -> Result<Mesh, String> {
    let class = &object.class;
    let indices: &[i32] = match object.field("indices") {
        Some(JavaValue::Ints(indices)) => indices,
        Some(JavaValue::Null) => &[],
        _ => return Err(format!("the class {class} is not known; it has no int[] indices")),
    };
    let positions = vectors::<3>(object, "v")?;
    let vertices = positions.len();
    let vertex = |&index: &i32| {
        let valid = usize::try_from(index).is_ok_and(|index| index < vertices);
        if valid {
            Ok(index.unsigned_abs())
        } else {
            Err(format!("index {index} refers to no vertex, there are {vertices}"))
        }
    };
    let (corners, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(format!("{} indices make no whole triangles", indices.len()));
    }
    let triangles = corners
        .iter()
        .map(|[a, b, c]| Ok([vertex(a)?, vertex(b)?, vertex(c)?]))
        .collect::<Result<_, String>>()?;
    Ok(Mesh {
        triangles,
        normals: per_vertex(vectors(object, "n")?, vertices, "normals")?,
        uvs: per_vertex(vectors(object, "t")?, vertices, "texture coordinates")?,
        positions,
    })
}

/// A field of type float[] as vectors; empty if it is null or missing.
fn vectors<const N: usize>(object: &JavaObject, name: &str) -> Result<Arc<[[f32; N]]>, String> {
    let numbers = match object.field(name) {
        Some(JavaValue::Floats(numbers)) => numbers,
        Some(JavaValue::Null) | None => return Ok(Arc::default()),
        Some(_) => return Err(format!("field {name} is no float[]")),
    };
    let (vectors, rest) = numbers.as_chunks::<N>();
    if !rest.is_empty() {
        return Err(format!("field {name} has {} numbers, which is no multiple of {N}", numbers.len()));
    }
    if numbers.iter().any(|number| !number.is_finite()) {
        return Err(format!("field {name} holds numbers that are not finite"));
    }
    Ok(vectors.into())
}

fn per_vertex<T>(values: Arc<[T]>, vertices: usize, what: &str) -> Result<Arc<[T]>, String> {
    if values.is_empty() || values.len() == vertices {
        Ok(values)
    } else {
        Err(format!("there are {vertices} vertices, but {} {what}", values.len()))
    }
}
