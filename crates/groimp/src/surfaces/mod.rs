//! Shapes that become triangles: surfaces of splines, grids and formulas (scene-format.md 4.1 and 4.3 to 4.6).
//!
//! Every surface is described by values that can be compared, so that a thousand equal leaves share one mesh.

mod bspline;
mod grid;
mod lamella;
mod patch;
mod polygon;
mod sphere_segment;
mod supershape;
mod values;

pub(crate) use patch::Heights;

use crate::fields::Fields;
use crate::images::Images;
use crate::meshes::visible_sides;
use crate::output::Output;
use crate::shapes::Geometry;
use crate::{Flatness, ReadError, ReadOptions};
use bspline::{BSplineSurface, Direction};
use glam::{DAffine3, DVec3, DVec4};
use grid::{Surface, tessellate};
use lamella::Lamella;
use patch::{HeightField, VertexGrid};
use scene::{Mesh, MeshId, Shape, VisibleSides};
use sphere_segment::SphereSegment;
use std::collections::HashMap;
use supershape::{Superformula, Supershape};
use values::ObjectValue;

/// GroIMP's classes of shapes that become triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SurfaceClass {
    SphereSegment,
    Supershape,
    Lamella,
    Patch,
    Polygon,
    Nurbs,
}

impl SurfaceClass {
    /// Whether the class puts its nodes into layer 1, and lets them say which of their sides can be seen.
    pub fn is_sheet(self) -> bool {
        matches!(self, SurfaceClass::Patch | SurfaceClass::Polygon | SurfaceClass::Nurbs)
    }
}

/// A surface that fails counts as much as one of so many triangles.
const FAILURE: usize = 512;

/// What tells one surface from another.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    class: SurfaceClass,
    /// Bits of all numbers that the shape depends on.
    numbers: Vec<u64>,
    /// Picture of a height field.
    image: Option<String>,
}

/// A surface, or why there is nothing to draw.
type Described<T> = Result<T, String>;

/// A surface as the file describes it.
enum Description {
    SphereSegment(Described<SphereSegment>),
    Function { surface: Described<Box<dyn Surface>>, flatness: f64 },
    Grid(VertexGrid),
    HeightField { field: HeightField, file: String },
    Polygon(Vec<DVec3>),
    Nothing(String),
}

/// All meshes that were made of surfaces, each built once.
pub(crate) struct Surfaces {
    images: Images,
    flatness: Flatness,
    most_triangles: usize,
    triangles_left: usize,
    by_key: HashMap<Key, Result<MeshId, String>>,
}

impl Surfaces {
    pub fn new(options: &ReadOptions, images: Images) -> Self {
        let limit = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX);
        Surfaces {
            images,
            flatness: options.flatness,
            most_triangles: limit(options.limits.surface_triangles),
            triangles_left: limit(options.limits.total_surface_triangles),
            by_key: HashMap::new(),
        }
    }

    /// The mesh of a node; the inner error says why there is none to draw.
    pub fn geometry(
        &mut self,
        class: SurfaceClass,
        fields: &Fields<'_>,
        out: &mut Output,
    ) -> Result<Result<Geometry, String>, ReadError> {
        let visible_sides = if class.is_sheet() { visible_sides(fields)? } else { VisibleSides::Both };
        let (key, description) = describe(class, fields, &self.images)?;
        let mesh = match self.by_key.get(&key) {
            Some(known) => known.clone(),
            None => {
                let built = self.build(description, fields, out)?;
                let mesh = built.and_then(|mesh| {
                    // Two corners of a triangle at one place are no triangle; all of them may be like that.
                    if mesh.triangles.is_empty() {
                        return Err("it has no extent".to_owned());
                    }
                    Ok((mesh.triangles.len(), out.scene.add_mesh(mesh)))
                });
                let triangles = built_triangles(&mesh);
                self.triangles_left = self.triangles_left.saturating_sub(triangles);
                let mesh = mesh.map(|(_, mesh)| mesh);
                self.by_key.insert(key, mesh.clone());
                mesh
            }
        };
        Ok(mesh.map(|mesh| Geometry {
            shape: Shape::Mesh { mesh, visible_sides },
            own_from_object: DAffine3::IDENTITY,
        }))
    }

    fn build(
        &mut self,
        description: Description,
        fields: &Fields<'_>,
        out: &mut Output,
    ) -> Result<Result<Mesh, String>, ReadError> {
        let most = self.most_triangles.min(self.triangles_left);
        if most == 0 {
            return Ok(Err("the surfaces of this project have too many triangles".to_owned()));
        }
        let location = || fields.graph.location(fields.graph.node(fields.node).line);
        let mut warn_if_coarser = |coarser: bool| {
            if coarser {
                let type_name = fields.graph.type_name(fields.node);
                let message =
                    format!("{type_name}: its surface is drawn coarser, with {most} triangles at most");
                out.report.warn(message, location());
            }
        };
        Ok(match description {
            Description::Nothing(reason) => Err(reason),
            Description::SphereSegment(segment) => segment.and_then(|segment| {
                let (mesh, coarser) = segment.mesh(self.flatness.tolerance(segment.diagonal()), most)?;
                warn_if_coarser(coarser);
                Ok(mesh)
            }),
            Description::Function { surface, flatness } => surface.and_then(|surface| {
                let tolerance = |diagonal: f64| self.flatness.tolerance(diagonal) * flatness;
                let tessellation = tessellate(&*surface, tolerance, most)?;
                warn_if_coarser(tessellation.coarser);
                Ok(tessellation.mesh)
            }),
            Description::Polygon(corners) if corners.len() > most => {
                Err(format!("its {} corners are more than the limit allows", corners.len()))
            }
            Description::Polygon(corners) => polygon::polygon(&corners),
            Description::Grid(grid) if grid.points.len().saturating_mul(2) > most => {
                Err(format!("its {} points are more than the limit allows", grid.points.len()))
            }
            Description::Grid(grid) => grid.mesh(),
            Description::HeightField { field, file } => match self.images.heights(&file)? {
                Err(problem) => Err(format!("its image '{file}' {problem}")),
                Ok(heights) => field.grid(&heights, most).and_then(|(grid, coarser)| {
                    warn_if_coarser(coarser);
                    grid.mesh()
                }),
            },
        })
    }
}

/// What a surface takes of the triangles that are left. Also one that fails was work, which has to end.
fn built_triangles(built: &Result<(usize, MeshId), String>) -> usize {
    built.as_ref().map_or(FAILURE, |(triangles, _)| *triangles)
}

fn describe(
    class: SurfaceClass,
    fields: &Fields<'_>,
    images: &Images,
) -> Result<(Key, Description), ReadError> {
    let mut key = Key { class, numbers: Vec::new(), image: None };
    let number = |name: &str, default: f64| fields.number(name, default);
    let description = match class {
        SurfaceClass::SphereSegment => {
            // The defaults, of a whole sphere, are unverified.
            let pi = std::f64::consts::PI;
            let radius = number("radius", 1.0)?;
            let [theta1, theta2] = [number("theta1", 0.0)?, number("theta2", pi)?];
            let phi = number("phi", 2.0 * pi)?;
            key.numbers = bits(&[radius, theta1, theta2, phi]);
            let segment = SphereSegment::new(radius, theta1, theta2, phi);
            Description::SphereSegment(segment.ok_or_else(|| "it has no extent".to_owned()))
        }
        SurfaceClass::Supershape => {
            // The defaults, of a sphere of radius 1, are unverified.
            let (a, b) = (number("a", 1.0)?, number("b", 1.0)?);
            let formula = |m: &str, [n1, n2, n3]: [&str; 3]| {
                let (m, n1) = (number(m, 0.0)?, number(n1, 1.0)?);
                Ok::<_, ReadError>(Superformula { a, b, m, n1, n2: number(n2, 1.0)?, n3: number(n3, 1.0)? })
            };
            let theta = formula("m1", ["n11", "n12", "n13"])?;
            let phi = formula("m2", ["n21", "n22", "n23"])?;
            for f in [theta, phi] {
                key.numbers.extend(bits(&[f.a, f.b, f.m, f.n1, f.n2, f.n3]));
            }
            let finite = key.numbers.iter().all(|number| f64::from_bits(*number).is_finite());
            function(finite, Supershape { theta, phi })
        }
        SurfaceClass::Lamella => {
            // That it is as large as other shapes by default, and flat, is unverified.
            let (width, height) = (number("width", 1.0)?.abs(), number("height", 1.0)?);
            let (a, b) = (number("a", 0.0)?, number("b", 0.0)?);
            let shift_pivot = fields.flag("shiftPivot", false)?;
            key.numbers = bits(&[width, height, a, b, f64::from(u8::from(shift_pivot))]);
            let finite = [width, height, a, b].iter().all(|number| number.is_finite());
            function(finite, Lamella { width, height, a, b, shift_pivot })
        }
        SurfaceClass::Patch => match ObjectValue::of_field(fields, "grid") {
            Ok(grid) => patch(grid, &mut key, images)?,
            Err(reason) => Description::Nothing(reason),
        },
        SurfaceClass::Polygon => match ObjectValue::of_field(fields, "vertices") {
            Ok(vertices) if vertices.short_class() == "VertexListImpl" || vertices.class.is_empty() => {
                let corners = points(&vertices)?;
                key.numbers = corners.iter().flatten().flat_map(|p| bits(&p.to_array())).collect();
                corners.map_or_else(Description::Nothing, Description::Polygon)
            }
            Ok(other) => not_read("vertices", other),
            Err(reason) => Description::Nothing(reason),
        },
        SurfaceClass::Nurbs => match ObjectValue::of_field(fields, "surface") {
            Ok(surface) => spline(surface, number("flatness", 1.0)?, &mut key)?,
            Err(reason) => Description::Nothing(reason),
        },
    };
    if let Description::Nothing(reason) = &description {
        // Otherwise all that cannot be drawn would share one reason.
        key.image = Some(format!("nothing: {reason}"));
    }
    Ok((key, description))
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

fn function(finite: bool, surface: impl Surface + 'static) -> Description {
    let surface: Described<Box<dyn Surface>> =
        if finite { Ok(Box::new(surface)) } else { Err("one of its fields is not a number".to_owned()) };
    Description::Function { surface, flatness: 1.0 }
}

fn not_read(what: &str, object: ObjectValue<'_>) -> Description {
    Description::Nothing(format!("its {what} of class '{}' is not supported", object.short_class()))
}

/// The points in `data`, of which each has `dimension` numbers.
fn points(object: &ObjectValue<'_>) -> Result<Described<Vec<DVec3>>, ReadError> {
    let dimension = object.count("dimension", 3)?;
    if !(2..=3).contains(&dimension) {
        return Ok(Err(format!("its points have {dimension} coordinates instead of 2 or 3")));
    }
    let data = object.numbers("data")?;
    if !data.len().is_multiple_of(dimension) {
        return Ok(Err(format!("its {} numbers are no points with {dimension} coordinates", data.len())));
    }
    let point = |p: &[f64]| DVec3::new(p[0], p[1], p.get(2).copied().unwrap_or(0.0));
    Ok(Ok(data.chunks_exact(dimension).map(point).collect()))
}

fn patch(grid: ObjectValue<'_>, key: &mut Key, images: &Images) -> Result<Description, ReadError> {
    match grid.short_class() {
        "VertexGridImpl" | "" => {
            let points = match points(&grid)? {
                Ok(points) => points,
                Err(reason) => return Ok(Description::Nothing(reason)),
            };
            let u_count = grid.count("uCount", 0)?;
            if u_count == 0 || !points.len().is_multiple_of(u_count) {
                let reason = format!("its {} points make no rows of {u_count}", points.len());
                return Ok(Description::Nothing(reason));
            }
            key.numbers = points.iter().flat_map(|p| bits(&p.to_array())).collect();
            key.numbers.push(u_count as u64);
            Ok(Description::Grid(VertexGrid { u_count, v_count: points.len() / u_count, points }))
        }
        "ImageHeightField" => {
            let path = grid.find("image").and_then(|image| crate::inline::registry_path(image.text()));
            let Some(file) = path.and_then(|path| images.file(&path)) else {
                return Ok(Description::Nothing("its grid names no image of the project".to_owned()));
            };
            let mapping = match grid.object("mapping") {
                Ok(mapping) => Some(mapping),
                Err(_) if grid.find("mapping").is_none() => None,
                Err(reason) => return Ok(Description::Nothing(reason)),
            };
            if let Some(mapping) = mapping
                && !matches!(mapping.short_class(), "RectangularHeightFieldMapping" | "")
            {
                return Ok(not_read("mapping", mapping));
            }
            let number = |name: &str, default: f64| mapping.map_or(Ok(default), |m| m.number(name, default));
            let field = HeightField {
                x_width: number("xWidth", 1.0)?,
                y_width: number("yWidth", 1.0)?,
                scale: number("scale", 1.0)?,
                zero_level: number("zeroLevel", 0.0)?,
                water: mapping.map_or(Ok(false), |m| m.flag("water", false))?,
            };
            let HeightField { x_width, y_width, scale, zero_level, water } = field;
            key.numbers = bits(&[x_width, y_width, scale, zero_level, f64::from(u8::from(water))]);
            key.image = Some(file.clone());
            Ok(Description::HeightField { field, file })
        }
        _ => Ok(not_read("grid", grid)),
    }
}

/// A Bezier or B-spline surface; the other classes are made of curves in ways that are not known here.
fn spline(surface: ObjectValue<'_>, flatness: f64, key: &mut Key) -> Result<Description, ReadError> {
    let is_bezier = match surface.short_class() {
        "BezierSurface" => true,
        "BSplineSurfaceImpl" => false,
        _ => return Ok(not_read("surface", surface)),
    };
    let rational = surface.flag("rational", false)?;
    let dimension = surface.count("dimension", if rational { 4 } else { 3 })?;
    let u_count = surface.count("uCount", 0)?;
    let mut degrees = [0; 2];
    let mut periodic = [false; 2];
    if !is_bezier {
        degrees = [surface.count("uDegree", 3)?, surface.count("vDegree", 3)?];
        periodic = [surface.flag("uPeriodic", false)?, surface.flag("vPeriodic", false)?];
    }
    let data = surface.numbers("data")?;
    key.numbers = bits(&data);
    key.numbers.extend([u64::from(is_bezier), u64::from(rational), dimension as u64, u_count as u64]);
    key.numbers.extend([degrees[0] as u64, degrees[1] as u64, periodic[0].into(), periodic[1].into()]);
    key.numbers.push(flatness.to_bits());
    let layout = Layout { is_bezier, rational, dimension, u_count, degrees, periodic };
    let surface = layout.surface(&data).map(|surface| Box::new(surface) as Box<dyn Surface>);
    // The meaning of `flatness` is unverified: 1, the default, is taken as the fineness that is asked for.
    let flatness = if flatness.is_finite() { flatness.clamp(0.01, 100.0) } else { 1.0 };
    Ok(Description::Function { surface, flatness })
}

/// How the numbers of a spline surface are to be read.
struct Layout {
    is_bezier: bool,
    rational: bool,
    dimension: usize,
    u_count: usize,
    degrees: [usize; 2],
    periodic: [bool; 2],
}

impl Layout {
    fn surface(&self, data: &[f64]) -> Described<BSplineSurface> {
        let Layout { dimension, u_count, .. } = *self;
        let coordinates = if self.rational { dimension.saturating_sub(1) } else { dimension };
        if !(2..=3).contains(&coordinates) {
            return Err(format!("its points have {coordinates} coordinates instead of 2 or 3"));
        }
        if u_count == 0 || u_count > data.len() {
            return Err(format!("its {} numbers make no rows of {u_count} points", data.len()));
        }
        // Periodic directions have the knots of the control points that are used again, too.
        let extra = [0, 1].map(|i| if self.periodic[i] { 2 } else { 1 } * self.degrees[i].min(data.len()));
        let knots = if self.is_bezier { 0 } else { 1 };
        let beyond = knots * (extra[0] + 1 + extra[1] + 1 + u_count);
        let rest = data.len().saturating_sub(beyond);
        let each = dimension.saturating_mul(u_count).saturating_add(knots);
        if rest == 0 || !rest.is_multiple_of(each) {
            let count = data.len();
            return Err(format!("its {count} numbers make no rows of {u_count} points with their knots"));
        }
        let v_count = rest / each;
        let (points, knots) = data.split_at(u_count * v_count * dimension);
        let point = |p: &[f64]| {
            let w = if self.rational { p[coordinates] } else { 1.0 };
            DVec4::new(p[0], p[1], if coordinates == 3 { p[2] } else { 0.0 }, w)
        };
        let points = points.chunks_exact(dimension).map(point).collect();
        let [u, v] = if self.is_bezier {
            [Direction::bezier(u_count)?, Direction::bezier(v_count)?]
        } else {
            let (u_knots, v_knots) = knots.split_at(u_count + extra[0] + 1);
            let direction = |i: usize, count: usize, knots: &[f64]| {
                Direction::new(count, self.degrees[i], self.periodic[i], knots.to_vec())
            };
            [direction(0, u_count, u_knots)?, direction(1, v_count, v_knots)?]
        };
        BSplineSurface::new(u, v, points)
    }
}
