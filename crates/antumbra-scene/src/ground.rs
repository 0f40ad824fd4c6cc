//! A ground for scenes that have none.

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::{Instance, Material, Mesh, Scene};

/// Side of the ground over the scene's diagonal. Shadows of a light half as high as the default light still end on the
/// ground.
const SIDE_DIAGONALS: f32 = 4.0;
/// Linear reflectance of the ground: paper in shade, so that both light and dark objects stand out.
const GRAY: f32 = 0.5;

/// Smallest fraction of a scene's outline, seen from above, that is as low as its lowest tenth if the scene has a ground.
const BARE: f32 = 0.25;
const LOWEST: f32 = 0.1;
/// Number of grid cells along x and along z.
const CELLS: usize = 24;
/// Largest ratio of height to diagonal of a scene that is itself a ground.
const FLAT: f32 = 0.02;

/// Condition for putting a ground under a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ground {
    /// If neither the scene nor a setup gives a camera and the scene stands on nothing.
    #[default]
    Auto,
    /// Always.
    Yes,
    /// Never.
    No,
}

impl Ground {
    /// Whether `scene` gets a ground. `is_framed` says that the camera frames the scene by default; see
    /// [`Assumed`](crate::Assumed).
    pub fn is_for(self, scene: &Scene, is_framed: bool) -> bool {
        match self {
            Self::Yes => true,
            Self::No => false,
            Self::Auto => is_framed && scene.lacks_ground(),
        }
    }

    /// Message about a ground that [`Ground::Auto`] added.
    pub fn told(scene: &Scene) -> String {
        format!("{} has no ground, so a ground plane was added; --ground=no omits it", scene.name)
    }
}

impl Scene {
    /// Whether the scene has no ground of its own, as a single object: seen from above, hardly any of its outline is as low as its
    /// lowest parts. A slope without a level foot also counts as such an object.
    pub fn lacks_ground(&self) -> bool {
        let bounds = self.bounds();
        let extent = bounds.max - bounds.min;
        if bounds.is_empty() || extent.y < FLAT * bounds.diagonal() {
            return false;
        }
        let cells_a_m = Vec2::splat(CELLS as f32) / Vec2::new(extent.x, extent.z).max(Vec2::splat(f32::MIN_POSITIVE));
        let mut tops = [f32::NEG_INFINITY; CELLS * CELLS];
        for triangle in self.world_triangles() {
            let corners = triangle
                .positions
                .map(|p| ((Vec2::new(p.x, p.z) - Vec2::new(bounds.min.x, bounds.min.z)) * cells_a_m).extend(p.y));
            raise(&mut tops, corners);
        }
        let low = bounds.min.y + LOWEST * extent.y;
        let bare = tops.iter().filter(|top| top.is_finite() && **top <= low).count();
        (bare as f32) < BARE * tops.len() as f32
    }

    /// Puts a square under the scene, at the lowest point of its bounding box, four of the box's diagonals wide. It is a mesh like
    /// others, named `ground`. [`Scene::ground`] identifies it, because it occludes nothing where light comes from above. A scene
    /// without triangles stays unchanged.
    pub fn add_ground(&mut self) {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return;
        }
        let half_m = 0.5 * SIDE_DIAGONALS * bounds.diagonal();
        let middle = bounds.center().with_y(bounds.min.y);
        let corner = |x: f32, z: f32| middle + half_m * Vec3::new(x, 0.0, z);
        let material = self.materials.len();
        self.materials.push(Material {
            name: "ground".into(),
            base_color: Vec4::new(GRAY, GRAY, GRAY, 1.0),
            roughness: 0.95,
            ..Material::default()
        });
        self.ground = Some(self.instances.len());
        self.instances.push(Instance { mesh: self.meshes.len(), world_from_object: Mat4::IDENTITY });
        self.meshes.push(Mesh {
            name: "ground".into(),
            positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
            normals: vec![Vec3::Y; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            material,
            ..Mesh::default()
        });
    }
}

/// Raises each cell whose centre a triangle covers, seen from above, to the triangle's height there. x and y of `corners` are in
/// cells, z is the height.
fn raise(tops: &mut [f32; CELLS * CELLS], corners: [Vec3; 3]) {
    let [a, b, c] = corners;
    let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
    let doubled_area = ab.perp_dot(ac);
    if doubled_area == 0.0 {
        return;
    }
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    // Centres lie half a cell in; a cast saturates.
    let cells =
        |least: f32, most: f32| (least - 0.5).ceil().max(0.0) as usize..((most + 0.5).floor() as usize).min(CELLS);
    for (row, column) in cells(least.y, most.y).flat_map(|row| cells(least.x, most.x).map(move |column| (row, column)))
    {
        let offset = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) - a.truncate();
        let (u, v) = (offset.perp_dot(ac) / doubled_area, ab.perp_dot(offset) / doubled_area);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
            let top = &mut tops[row * CELLS + column];
            *top = top.max(a.z + u * (b.z - a.z) + v * (c.z - a.z));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{LoadOptions, Scene, load};

    #[test]
    fn the_ground_lies_under_all_and_faces_up() {
        let mut scene = load("builtin:knot?triangles=1000", &LoadOptions::default()).unwrap();
        let (before, triangles) = (scene.bounds(), scene.triangle_count());
        scene.add_ground();
        let after = scene.bounds();
        assert_eq!((after.min.y, after.max.y, scene.triangle_count()), (before.min.y, before.max.y, triangles + 2));
        assert!((after.max.x - after.min.x - 4.0 * before.diagonal()).abs() < 1e-3);
        for triangle in
            scene.world_triangles().filter(|triangle| triangle.instance as usize == scene.instances.len() - 1)
        {
            let [a, b, c] = triangle.positions;
            assert!((b - a).cross(c - a).normalize().y > 0.999);
        }
        let mut nothing = Scene::default();
        nothing.add_ground();
        assert!(nothing.meshes.is_empty());
    }

    /// Built-in scenes have grounds; a knot without one stands on nothing until it is put on a ground.
    #[test]
    fn objects_stand_on_nothing_until_they_are_put_on_something() {
        for name in ["overlap", "columns", "tree", "street", "bench-under-tree", "town"] {
            let scene = load(&format!("builtin:{name}"), &LoadOptions::default()).unwrap();
            assert!(!scene.lacks_ground(), "{name}");
        }
        let mut knot = load("builtin:knot?triangles=1000", &LoadOptions::default()).unwrap();
        knot.instances.retain(|instance| knot.meshes[instance.mesh].name == "knot");
        assert!(knot.lacks_ground());
        knot.add_ground();
        assert!(!knot.lacks_ground());
        assert!(!Scene::default().lacks_ground());
    }
}
