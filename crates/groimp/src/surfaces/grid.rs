//! Triangles for surfaces that are given as a function of two parameters.
//!
//! The parameters are cut at the surface's own breaks (kinks, knots) and each piece evenly, until the chords in
//! both directions, and the diagonals of the cells, are as near to the surface as asked for. All cells of a row and
//! of a column share their lines, so there are no gaps. Pieces have vertices of their own, with the normal of
//! their side: edges stay sharp where the surface has one. Where two pieces, or two ends of a closed surface,
//! meet, the function yields the same position and so do the vertices, bit for bit.

use glam::DVec3;
use scene::Mesh;

/// A surface over the unit square. In front of it, the first tangent turns counter-clockwise to the second.
pub(super) trait Surface {
    /// A point in object space. It has to be exactly the same where the surface is closed or shrinks to a point.
    fn point(&self, s: f64, t: f64) -> DVec3;
    /// The derivatives by both parameters; never asked for at breaks.
    fn tangents(&self, s: f64, t: f64) -> [DVec3; 2];
    /// Parameters, ascending from 0 to 1, between which the surface is smooth; one list for each direction.
    fn breaks(&self) -> [Vec<f64>; 2];
    /// Cells with which to begin in each piece: as many as make waves of the surface visible to samples.
    fn least_cells(&self) -> [usize; 2];
    /// Texture coordinates.
    fn uv(&self, s: f64, t: f64) -> [f64; 2] {
        [s, t]
    }
}

/// How finely a surface is cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fineness {
    /// Largest distance in metres between surface and triangles.
    pub tolerance: f64,
    /// Most triangles that a surface may become.
    pub most_triangles: usize,
}

/// Triangles of a surface.
pub(super) struct Tessellation {
    pub mesh: Mesh,
    /// The limit of triangles made it coarser than asked for.
    pub coarser: bool,
}

/// Cells in a direction at most, if there are not many pieces; it bounds the work on surfaces that no number of
/// cells follows.
const MOST_CELLS: usize = 1 << 12;

/// Cells in each of many pieces at most.
const MOST_CELLS_OF_MANY: usize = 16;

/// Lines across, per piece, on which the chords of a direction are measured.
const PROBES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// How far inside its cell a normal at the edge of a piece is taken, in cells.
const INSIDE: f64 = 1e-5;

/// Cuts a surface into triangles; an error says why there are none.
pub(super) fn tessellate(
    surface: &dyn Surface,
    tolerance: impl FnOnce(f64) -> f64,
    most_triangles: usize,
) -> Result<Tessellation, String> {
    let breaks = surface.breaks();
    let pieces = [breaks[0].len() - 1, breaks[1].len() - 1];
    if pieces[0].saturating_mul(pieces[1]).saturating_mul(2) > most_triangles {
        return Err(format!("its {} x {} pieces are more than the limit allows", pieces[0], pieces[1]));
    }
    let diagonal = extent(surface, &breaks)?;
    let fineness = Fineness { tolerance: tolerance(diagonal), most_triangles };
    let (lines, coarser) = cut(surface, &breaks, fineness);
    let mesh = mesh(surface, &lines)?;
    Ok(Tessellation { mesh, coarser })
}

/// Diagonal of the box round points of the surface.
fn extent(surface: &dyn Surface, breaks: &[Vec<f64>; 2]) -> Result<f64, String> {
    let [s, t] = [0, 1].map(|direction| lines(&breaks[direction], &[8]));
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    // A coarse look will do where there are many pieces.
    let step = |lines: &[f64]| lines.len().div_ceil(256);
    for s in s.iter().step_by(step(&s)) {
        for t in t.iter().step_by(step(&t)) {
            let point = surface.point(*s, *t);
            if !point.is_finite() {
                return Err("it has points that are not finite".to_owned());
            }
            (low, high) = (low.min(point), high.max(point));
        }
    }
    let diagonal = (high - low).length();
    if diagonal > 0.0 { Ok(diagonal) } else { Err("it has no extent".to_owned()) }
}

/// The parameters of the grid lines of all pieces, for both directions, and whether the limit made them fewer.
fn cut(surface: &dyn Surface, breaks: &[Vec<f64>; 2], fineness: Fineness) -> ([Vec<f64>; 2], bool) {
    let least = surface.least_cells();
    let mut cells = [0, 1].map(|direction| {
        let across = lines_of_probes(&breaks[1 - direction]);
        let point = |along: f64, across: f64| match direction {
            0 => surface.point(along, across),
            _ => surface.point(across, along),
        };
        let pieces = breaks[direction].len() - 1;
        let most = (MOST_CELLS / pieces).max(MOST_CELLS_OF_MANY);
        let piece = |ends: &[f64]| {
            let fit = |cells| chords_fit(&point, [ends[0], ends[1]], cells, &across, fineness.tolerance);
            let least = least[direction].clamp(1, most);
            let mut cells = least;
            while cells < most && !fit(cells) {
                cells *= 2;
            }
            // Twice as many may have been too many.
            for step in [cells / 4, cells / 8, cells / 16] {
                if step > 0 && cells - step > least && cells <= most && fit(cells - step) {
                    cells -= step;
                }
            }
            cells.min(most)
        };
        breaks[direction].windows(2).map(piece).collect::<Vec<_>>()
    });
    let mut coarser = false;
    let count = |cells: &[Vec<usize>; 2]| {
        let [s, t] = [0, 1].map(|direction| cells[direction].iter().sum::<usize>());
        s.saturating_mul(t).saturating_mul(2)
    };
    while count(&cells) > fineness.most_triangles {
        coarser = true;
        for piece in cells.iter_mut().flatten() {
            *piece = piece.div_ceil(2);
        }
    }
    loop {
        let grid = [0, 1].map(|direction| lines(&breaks[direction], &cells[direction]));
        if diagonals_fit(surface, &grid, fineness.tolerance) {
            return (grid, coarser);
        }
        let finer = cells.clone().map(|pieces| pieces.into_iter().map(|piece| 2 * piece).collect());
        if count(&finer) > fineness.most_triangles {
            return (grid, true);
        }
        cells = finer;
    }
}

/// Parameters of the lines of all pieces; a piece begins with the line that the one before it ends with. The last
/// number of cells counts for all further pieces.
fn lines(breaks: &[f64], cells: &[usize]) -> Vec<f64> {
    let mut lines = Vec::new();
    for (piece, ends) in breaks.windows(2).enumerate() {
        let cells = cells.get(piece).or(cells.last()).copied().unwrap_or(1);
        for i in 0..cells {
            lines.push(ends[0] + (ends[1] - ends[0]) * (i as f64 / cells as f64));
        }
        lines.push(ends[1]);
    }
    lines
}

fn lines_of_probes(breaks: &[f64]) -> Vec<f64> {
    let probes = |ends: &[f64]| PROBES.map(|part| ends[0] + (ends[1] - ends[0]) * part);
    let all: Vec<f64> = breaks.windows(2).flat_map(probes).collect();
    let step = all.len().div_ceil(32);
    all.into_iter().step_by(step).collect()
}

/// Whether the surface stays near the chords of a piece.
fn chords_fit(
    point: &dyn Fn(f64, f64) -> DVec3,
    ends: [f64; 2],
    cells: usize,
    across: &[f64],
    tolerance: f64,
) -> bool {
    let at = |i: f64| ends[0] + (ends[1] - ends[0]) * (i / cells as f64);
    across.iter().all(|&across| {
        let mut start = point(ends[0], across);
        (0..cells).all(|cell| {
            let cell = cell as f64;
            let end = point(at(cell + 1.0), across);
            let fits = [0.25, 0.5, 0.75]
                .iter()
                .all(|part| distance_to_segment(point(at(cell + part), across), start, end) <= tolerance);
            start = end;
            fits
        })
    })
}

/// Whether the surface stays near the diagonals of the cells.
fn diagonals_fit(surface: &dyn Surface, grid: &[Vec<f64>; 2], tolerance: f64) -> bool {
    let step = |lines: &[f64]| lines.len().div_ceil(128);
    let pairs = |direction: usize| grid[direction].windows(2).step_by(step(&grid[direction]));
    pairs(0).filter(|s| s[0] < s[1]).all(|s| {
        pairs(1).filter(|t| t[0] < t[1]).all(|t| {
            let corner = |i: usize, j: usize| surface.point(s[i], t[j]);
            let (a, c) = (corner(0, 0), corner(1, 1));
            let (b, d) = (corner(1, 0), corner(0, 1));
            let centre = surface.point(0.5 * (s[0] + s[1]), 0.5 * (t[0] + t[1]));
            let (from, to) = if first_diagonal(a, b, c, d) { (a, c) } else { (b, d) };
            // A cell at a pole has only one triangle and no diagonal.
            let collapsed = a == b || b == c || c == d || d == a;
            collapsed || distance_to_segment(centre, from, to) <= tolerance
        })
    })
}

/// Whether the diagonal from the first corner is not the longer one.
pub(super) fn first_diagonal(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> bool {
    a.distance_squared(c) <= b.distance_squared(d)
}

/// Distance of a point from a segment; infinite if it is not a number.
fn distance_to_segment(point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let along = to - from;
    let squared = along.length_squared();
    let part = if squared > 0.0 { ((point - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let distance = point.distance(from + along * part);
    if distance.is_nan() { f64::INFINITY } else { distance }
}

/// The triangles between the lines. Two equal lines in a row separate pieces.
fn mesh(surface: &dyn Surface, [s, t]: &[Vec<f64>; 2]) -> Result<Mesh, String> {
    let mut builder = MeshBuilder::default();
    for &v in t {
        for &u in s {
            builder.positions.push(narrowed(surface.point(u, v))?);
            builder.uvs.push(surface.uv(u, v).map(|coordinate| coordinate as f32));
        }
    }
    for j in 0..t.len() {
        for i in 0..s.len() {
            let normal = normal(surface, inner(s, i), inner(t, j));
            builder.normals.push(normal.to_array().map(|component| component as f32));
        }
    }
    let vertex = |i: usize, j: usize| j * s.len() + i;
    for j in (0..t.len() - 1).filter(|j| t[*j] < t[j + 1]) {
        for i in (0..s.len() - 1).filter(|i| s[*i] < s[i + 1]) {
            builder.quad([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
        }
    }
    Ok(builder.finish())
}

/// A line's parameter, and that of the middle of the cell beside it if it lies at an end of its piece.
fn inner(lines: &[f64], index: usize) -> (f64, Option<f64>) {
    let at = lines[index];
    let before = index.checked_sub(1).and_then(|i| lines.get(i)).copied().filter(|line| *line < at);
    let after = lines.get(index + 1).copied().filter(|line| *line > at);
    match (before, after) {
        (Some(_), Some(_)) | (None, None) => (at, None),
        (Some(cell), None) | (None, Some(cell)) => (at, Some(0.5 * (cell + at))),
    }
}

/// Unit normal; zero if the surface has none there or nearby.
fn normal(
    surface: &dyn Surface,
    (s, inner_s): (f64, Option<f64>),
    (t, inner_t): (f64, Option<f64>),
) -> DVec3 {
    // At poles and kinks the normal is the limit from inside of the cell. Where the derivatives vanish faster than
    // that, a look further inside helps.
    for inside in [INSIDE, 1e-3, 0.1, 0.5] {
        let towards =
            |at: f64, inner: Option<f64>| inner.map_or(at, |inner| at + (inner - at) * 2.0 * inside);
        let [ds, dt] = surface.tangents(towards(s, inner_s), towards(t, inner_t));
        let across = ds.cross(dt);
        let reference = ds.length() * dt.length();
        if across.is_finite() && reference > 0.0 && across.length() > 1e-9 * reference {
            return across.normalize_or_zero();
        }
    }
    DVec3::ZERO
}

/// A position with single precision.
pub(super) fn narrowed(point: DVec3) -> Result<[f32; 3], String> {
    // -0 and 0 are the same place.
    let narrow = point.to_array().map(|component| component as f32 + 0.0);
    if narrow.iter().all(|component| component.is_finite()) {
        Ok(narrow)
    } else {
        Err("it has points that are not finite".to_owned())
    }
}

/// Vertices and triangles that become a mesh.
#[derive(Default)]
pub(super) struct MeshBuilder {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

impl MeshBuilder {
    /// Adds a vertex; the result is its index.
    pub fn vertex(&mut self, position: [f32; 3], normal: DVec3, uv: [f64; 2]) -> usize {
        self.positions.push(position);
        self.normals.push(normal.to_array().map(|component| component as f32));
        self.uvs.push(uv.map(|coordinate| coordinate as f32));
        self.positions.len() - 1
    }

    /// Adds a triangle, counter-clockwise from the front; none if two corners are at the same place.
    pub fn triangle(&mut self, corners: [usize; 3]) {
        let [a, b, c] = corners.map(|corner| self.positions[corner]);
        if a != b && b != c && c != a {
            // The limits on triangles keep the number of vertices far below 2^32.
            self.triangles.push(corners.map(|corner| u32::try_from(corner).unwrap_or(u32::MAX)));
        }
    }

    /// Adds a quadrilateral, counter-clockwise from the front, cut along its shorter diagonal.
    pub fn quad(&mut self, [a, b, c, d]: [usize; 4]) {
        let corner = |index: usize| DVec3::from_array(self.positions[index].map(f64::from));
        if first_diagonal(corner(a), corner(b), corner(c), corner(d)) {
            self.triangle([a, b, c]);
            self.triangle([a, c, d]);
        } else {
            self.triangle([a, b, d]);
            self.triangle([b, c, d]);
        }
    }

    pub fn finish(self) -> Mesh {
        Mesh {
            positions: self.positions.into(),
            triangles: self.triangles.into(),
            normals: self.normals.into(),
            uvs: self.uvs.into(),
        }
    }
}
