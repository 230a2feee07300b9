//! Leaves as flat particles: a place, a plane, a size and what of a texture they show. What the
//! styles move, turn, enlarge and reshape (Coconu, Deussen, Hege 2006, section 5 and 6).

use glam::{Mat2, Vec2, Vec3};

use crate::scene::{Geometry, Model};

/// Triangles of leaves: those of leaf `k` are `triangles[first[k]..first[k + 1]]`, numbers of
/// triangles in `indices`.
#[derive(Debug, Clone, Copy)]
pub struct LeafTriangles<'a> {
    /// Triangle list, indices into the geometry's vertices.
    pub indices: &'a [u32],
    /// First entry in `triangles` of each leaf, closed by the total.
    pub first: &'a [u32],
    /// Triangle numbers.
    pub triangles: &'a [u32],
}

/// A leaf, flat.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Leaf {
    /// Middle of its box in its plane; metres, in the frame of the geometry.
    pub centre: Vec3,
    /// Unit normal: the mean of its triangles by area.
    pub normal: Vec3,
    /// Unit direction in its plane, from base to tip where the texture tells (against its v),
    /// else along its longest extent.
    pub axis: Vec3,
    /// Largest distance of its outline from the centre in its plane, metres: the radius of the
    /// disc that it can become.
    pub radius: f32,
    /// Area, m^2.
    pub area: f32,
    /// Texture coordinates of the centre, before the material's map.
    pub texcoord: Vec2,
    /// Change of texture coordinates per metre across (`side`) and along (`axis`).
    pub texcoord_per_metre: Mat2,
    /// Material.
    pub material: u32,
    /// Model instance: the object.
    pub instance: u32,
}

impl Leaf {
    /// Unit direction across the leaf: `axis` x `normal`.
    #[must_use]
    pub fn side(&self) -> Vec3 {
        self.axis.cross(self.normal)
    }

    /// A point of the leaf's plane by its coordinates across and along, in radii.
    #[must_use]
    pub fn point(&self, local: Vec2) -> Vec3 {
        self.centre + self.radius * (local.x * self.side() + local.y * self.axis)
    }

    /// Coordinates across and along, in radii, of a point projected onto the leaf's plane.
    #[must_use]
    pub fn local(&self, point: Vec3) -> Vec2 {
        let away = (point - self.centre) / self.radius;
        Vec2::new(away.dot(self.side()), away.dot(self.axis))
    }

    /// Texture coordinates at coordinates in radii, before the material's map.
    #[must_use]
    pub fn texcoord_at(&self, local: Vec2) -> Vec2 {
        self.texcoord + self.texcoord_per_metre * (local * self.radius)
    }
}

/// Every leaf of `triangles`, in their order; one without area is left out, and its entry of the
/// second list says so (`None`), else which leaf it became.
#[must_use]
pub fn leaves(
    model: &Model,
    geometry: &Geometry,
    triangles: LeafTriangles<'_>,
) -> (Vec<Leaf>, Vec<Option<u32>>) {
    let part_of = parts_of_vertices(geometry);
    let mut found = Vec::new();
    let mut kept = Vec::new();
    for range in triangles.first.windows(2) {
        let corners: Vec<[u32; 3]> = triangles.triangles[range[0] as usize..range[1] as usize]
            .iter()
            .map(|&t| [0, 1, 2].map(|k| triangles.indices[3 * t as usize + k]))
            .collect();
        let leaf = corners.first().and_then(|c| {
            let part = &geometry.parts[part_of[c[0] as usize] as usize];
            let owner = (part.material as u32, part.instance as u32);
            let textured = model.materials[part.material].base_color_texture.is_some();
            flat(geometry, &corners, owner, textured)
        });
        kept.push(leaf.map(|leaf| {
            found.push(leaf);
            found.len() as u32 - 1
        }));
    }
    (found, kept)
}

fn parts_of_vertices(geometry: &Geometry) -> Vec<u32> {
    let mut out = vec![0; geometry.positions.len()];
    for (number, part) in geometry.parts.iter().enumerate() {
        out[part.vertices()].fill(number as u32);
    }
    out
}

/// One leaf from its triangles; none where they have no area.
fn flat(
    g: &Geometry,
    corners: &[[u32; 3]],
    (material, instance): (u32, u32),
    textured: bool,
) -> Option<Leaf> {
    let at = |v: u32| g.positions[v as usize];
    let mut normal = Vec3::ZERO;
    let mut area = 0.0;
    for &[a, b, c] in corners {
        let twice = (at(b) - at(a)).cross(at(c) - at(a));
        // Folded leaves turn part of their triangles away; the sum keeps the mean direction.
        normal += twice;
        area += 0.5 * twice.length();
    }
    let normal = normal.try_normalize().or_else(|| {
        let first = corners
            .iter()
            .map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)));
        first
            .max_by(|a, b| a.length().total_cmp(&b.length()))?
            .try_normalize()
    })?;
    let vertices: Vec<u32> = corners.iter().flatten().copied().collect();
    let mapping = TextureMap::new(g, corners, normal);
    let along_v = mapping
        .as_ref()
        .filter(|_| textured)
        .and_then(|m| m.against_v());
    let axis = along_v.or_else(|| longest(g, &vertices, normal))?;
    let side = axis.cross(normal);
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let origin = at(vertices[0]);
    for &v in &vertices {
        let p = at(v) - origin;
        let p = Vec2::new(p.dot(side), p.dot(axis));
        low = low.min(p);
        high = high.max(p);
    }
    let middle = 0.5 * (low + high);
    let mut height = 0.0;
    let mut radius = 0.0_f32;
    for &v in &vertices {
        let p = at(v) - origin;
        height += p.dot(normal) / vertices.len() as f32;
        radius = radius.max(Vec2::new(p.dot(side), p.dot(axis)).distance(middle));
    }
    let centre = origin + middle.x * side + middle.y * axis + height * normal;
    let (texcoord, texcoord_per_metre) = mapping.map_or((Vec2::ZERO, Mat2::ZERO), |m| {
        let across = Mat2::from_cols(m.gradient(side), m.gradient(axis));
        (m.at(centre), across)
    });
    (radius > 0.0).then_some(Leaf {
        centre,
        normal,
        axis,
        radius,
        area,
        texcoord,
        texcoord_per_metre,
        material,
        instance,
    })
}

/// The direction in which the points reach farthest, in the plane of `normal`.
fn longest(g: &Geometry, vertices: &[u32], normal: Vec3) -> Option<Vec3> {
    let at = |v: u32| g.positions[v as usize];
    let pairs = vertices
        .iter()
        .flat_map(|&a| vertices.iter().map(move |&b| (a.min(b), a.max(b))));
    // Leaves of very many vertices: the farthest from the first, and the farthest from that one.
    let (a, b) = if vertices.len() <= 48 {
        pairs.max_by(|p, q| {
            let length = |(a, b): (u32, u32)| at(a).distance_squared(at(b));
            length(*p).total_cmp(&length(*q)).then(q.cmp(p))
        })?
    } else {
        let farthest = |from: u32| {
            let key = |v: &u32| at(*v).distance_squared(at(from));
            vertices
                .iter()
                .copied()
                .max_by(|a, b| key(a).total_cmp(&key(b)))
        };
        let end = farthest(vertices[0])?;
        (end, farthest(end)?)
    };
    let way = at(b) - at(a);
    (way - way.dot(normal) * normal).try_normalize()
}

/// Texture coordinates as an affine function of the place, least squares over the area.
struct TextureMap {
    place: Vec3,
    texcoord: Vec2,
    u: Vec3,
    v: Vec3,
}

impl TextureMap {
    /// The mean over the triangles of their own (exact) maps; none where no triangle has one.
    fn new(g: &Geometry, corners: &[[u32; 3]], normal: Vec3) -> Option<Self> {
        let mut total = 0.0;
        let (mut place, mut texcoord) = (Vec3::ZERO, Vec2::ZERO);
        let (mut u, mut v) = (Vec3::ZERO, Vec3::ZERO);
        for &c in corners {
            let p = c.map(|i| g.positions[i as usize]);
            let t = c.map(|i| Vec2::from(g.texcoords[i as usize]));
            let (e, f) = (p[1] - p[0], p[2] - p[0]);
            let twice = e.cross(f);
            let area = 0.5 * twice.length();
            let Some(n) = twice.try_normalize() else {
                continue;
            };
            let n = if n.dot(normal) < 0.0 { -n } else { n };
            // Gradients of the triangle's linear functions: of e and f the dual basis.
            let scale = twice.dot(n);
            let (de, df) = (f.cross(n) / scale, n.cross(e) / scale);
            let (a, b) = (t[1] - t[0], t[2] - t[0]);
            u += area * (a.x * de + b.x * df);
            v += area * (a.y * de + b.y * df);
            place += area * (p[0] + p[1] + p[2]) / 3.0;
            texcoord += area * (t[0] + t[1] + t[2]) / 3.0;
            total += area;
        }
        (total > 0.0).then(|| Self {
            place: place / total,
            texcoord: texcoord / total,
            u: u / total,
            v: v / total,
        })
    }

    fn gradient(&self, direction: Vec3) -> Vec2 {
        Vec2::new(self.u.dot(direction), self.v.dot(direction))
    }

    fn at(&self, point: Vec3) -> Vec2 {
        self.texcoord + self.gradient(point - self.place)
    }

    /// Textures of leaves stand upright with the tip up: v falls from base to tip.
    fn against_v(&self) -> Option<Vec3> {
        (-self.v).try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::geometry::Part;

    /// A card 2 m wide and 4 m high about `centre`, tip to +y, seen from +z.
    fn card(centre: Vec3) -> Geometry {
        let corner = |x: f32, y: f32| centre + Vec3::new(x, y, 0.0);
        Geometry {
            positions: vec![
                corner(-1.0, -2.0),
                corner(1.0, -2.0),
                corner(1.0, 2.0),
                corner(-1.0, 2.0),
            ],
            texcoords: vec![[0.0, 1.0], [0.5, 1.0], [0.5, 0.0], [0.0, 0.0]],
            indices: vec![0, 1, 2, 0, 2, 3],
            parts: vec![Part {
                instance: 0,
                mesh: 0,
                primitive: 0,
                material: 0,
                first_vertex: 0,
                vertex_count: 4,
                first_index: 0,
                index_count: 6,
            }],
            ..Geometry::default()
        }
    }

    fn only_leaf(g: &Geometry) -> Option<Leaf> {
        let mut model = Model {
            materials: vec![crate::scene::Material::default()],
            ..Model::default()
        };
        model.materials[0].base_color_texture = Some(crate::scene::TextureRef::new(0));
        let count = (g.indices.len() / 3) as u32;
        let triangles: Vec<u32> = (0..count).collect();
        let list = LeafTriangles {
            indices: &g.indices,
            first: &[0, count],
            triangles: &triangles,
        };
        leaves(&model, g, list).0.first().copied()
    }

    #[test]
    fn a_card_gives_its_plane_its_size_and_its_texture() {
        let leaf = only_leaf(&card(Vec3::new(3.0, 4.0, 5.0))).expect("a leaf");
        assert!(leaf.centre.distance(Vec3::new(3.0, 4.0, 5.0)) < 1e-5);
        assert!(leaf.normal.distance(Vec3::Z) < 1e-6);
        assert!(leaf.axis.distance(Vec3::Y) < 1e-6, "tip up: {}", leaf.axis);
        assert!((leaf.radius - 5.0_f32.sqrt()).abs() < 1e-5);
        assert!((leaf.area - 8.0).abs() < 1e-5);
        for (corner, uv) in [((-1.0, -2.0), [0.0, 1.0]), ((1.0, 2.0), [0.5, 0.0])] {
            let point = leaf.centre + Vec3::new(corner.0, corner.1, 0.0);
            let local = leaf.local(point);
            assert!(leaf.point(local).distance(point) < 1e-5);
            assert!(leaf.texcoord_at(local).distance(Vec2::from(uv)) < 1e-5);
        }
    }

    #[test]
    fn a_leaf_without_texture_lies_along_its_longest_extent() {
        let mut g = card(Vec3::ZERO);
        g.texcoords = vec![[0.0; 2]; 4];
        let leaf = only_leaf(&g).expect("a leaf");
        // The diagonal of the card.
        let diagonal = Vec3::new(1.0, 2.0, 0.0).normalize();
        let other = Vec3::new(-1.0, 2.0, 0.0).normalize();
        let along = leaf
            .axis
            .dot(diagonal)
            .abs()
            .max(leaf.axis.dot(other).abs());
        assert!(along > 0.999, "{}", leaf.axis);
    }

    #[test]
    fn leaves_without_area_are_left_out_and_said_to_be() {
        let mut g = card(Vec3::ZERO);
        g.positions = vec![Vec3::ONE; 4];
        assert_eq!(only_leaf(&g), None);
    }
}
