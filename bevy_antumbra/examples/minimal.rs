//! A rectangle light above a cube, which casts no shadow in Bevy alone.
//!
//! ```text
//! cargo run --features window --example minimal
//! ```

use bevy::prelude::*;
use bevy_antumbra::AntumbraPlugin;

fn main() {
    App::new().add_plugins((DefaultPlugins, AntumbraPlugin::default())).add_systems(Startup, setup).run();
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(12.0, 12.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.8, 0.75))),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::new(1.0, 1.0, 1.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.7, 0.3, 0.25))),
        Transform::from_xyz(0.0, 0.5, 0.0),
    ));
    // Width and height alone determine how soft the shadow is.
    commands.spawn((
        RectLight { width: 1.5, height: 0.5, intensity: 400_000.0, ..default() },
        Transform::from_xyz(2.0, 3.5, 1.5).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(-3.0, 3.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y)));
}
