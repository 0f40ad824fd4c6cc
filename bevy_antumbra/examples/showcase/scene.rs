//! Scene of the showcase: objects of several shapes, and a light of each kind that Bevy has.

use std::f32::consts::TAU;

use bevy::light::SunDisk;
use bevy::prelude::*;

/// Rotation about the entity's y axis.
#[derive(Component)]
pub struct Turns {
    /// Revolutions per minute.
    pub per_minute: f32,
}

/// Oscillation along x.
#[derive(Component)]
pub struct Glides {
    pub from: Vec3,
    pub reach_m: f32,
}

pub fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut matte =
        |color: Color| materials.add(StandardMaterial { base_color: color, perceptual_roughness: 0.9, ..default() });
    let (stone, clay, jade, brass) = (
        matte(Color::srgb(0.75, 0.73, 0.7)),
        matte(Color::srgb(0.72, 0.35, 0.26)),
        matte(Color::srgb(0.3, 0.55, 0.42)),
        matte(Color::srgb(0.75, 0.6, 0.3)),
    );
    commands.spawn((Mesh3d(meshes.add(Plane3d::default().mesh().size(30.0, 30.0))), MeshMaterial3d(stone.clone())));

    // A colonnade around the origin.
    let column = meshes.add(Cylinder::new(0.16, 2.0));
    for i in 0..9 {
        let (sin, cos) = (i as f32 / 9.0 * TAU).sin_cos();
        commands.spawn((
            Mesh3d(column.clone()),
            MeshMaterial3d(stone.clone()),
            Transform::from_xyz(3.2 * cos, 1.0, 3.2 * sin),
        ));
    }
    // A tumbling ring, and beads that circle it.
    commands.spawn((
        Mesh3d(meshes.add(Torus::new(0.55, 0.75))),
        MeshMaterial3d(brass),
        Transform::from_xyz(0.0, 1.3, 0.0).with_rotation(Quat::from_rotation_x(1.1)),
        Turns { per_minute: 5.0 },
    ));
    let bead = meshes.add(Sphere::new(0.14));
    let middle =
        commands.spawn((Transform::from_xyz(0.0, 0.9, 0.0), Visibility::default(), Turns { per_minute: 3.0 })).id();
    for i in 0..12 {
        let angle = i as f32 / 12.0 * TAU;
        let (sin, cos) = angle.sin_cos();
        let at = Vec3::new(1.7 * cos, 0.35 * (3.0 * angle).sin(), 1.7 * sin);
        let material = if i % 2 == 0 { clay.clone() } else { jade.clone() };
        commands.spawn((
            Mesh3d(bead.clone()),
            MeshMaterial3d(material),
            Transform::from_translation(at),
            ChildOf(middle),
        ));
    }
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::new(0.7, 0.35, 0.7))),
        MeshMaterial3d(clay),
        Transform::from_xyz(0.0, 0.17, 0.0),
    ));
    spawn_lights(&mut commands);
}

fn spawn_lights(commands: &mut Commands) {
    let from = Vec3::new(-2.0, 4.2, 2.4);
    commands.spawn((
        RectLight { color: Color::srgb(1.0, 0.85, 0.7), width: 1.6, height: 0.5, intensity: 500_000.0, ..default() },
        Transform::from_translation(from).looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::Y),
        Glides { from, reach_m: 1.5 },
    ));
    commands.spawn((
        SpotLight {
            color: Color::srgb(0.6, 0.75, 1.0),
            radius: 0.15,
            intensity: 1_500_000.0,
            inner_angle: 0.45,
            outer_angle: 0.6,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(4.0, 4.0, -1.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        PointLight {
            color: Color::srgb(1.0, 0.7, 0.4),
            radius: 0.12,
            intensity: 120_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(0.0, 2.6, 0.0),
    ));
    // A moon with four times the angular diameter of ours.
    commands.spawn((
        DirectionalLight {
            color: Color::srgb(0.6, 0.7, 1.0),
            illuminance: 500.0,
            shadow_maps_enabled: true,
            ..default()
        },
        SunDisk { angular_size: 0.036, intensity: 1.0 },
        Transform::default().looking_to(Vec3::new(-0.6, -0.8, -0.5), Vec3::Y),
    ));
}

/// Initial transform of the camera.
pub fn camera() -> Transform {
    Transform::from_xyz(0.0, 4.2, 7.4).looking_at(Vec3::new(0.0, 0.6, 0.0), Vec3::Y)
}

pub fn turn(time: Res<Time>, mut turning: Query<(&Turns, &mut Transform)>) {
    for (turns, mut transform) in &mut turning {
        transform.rotate_y(turns.per_minute / 60.0 * TAU * time.delta_secs());
    }
}

pub fn glide(time: Res<Time>, mut gliding: Query<(&Glides, &mut Transform)>) {
    for (glides, mut transform) in &mut gliding {
        transform.translation = glides.from + Vec3::X * glides.reach_m * (0.5 * time.elapsed_secs()).sin();
        transform.look_at(Vec3::new(0.0, 0.5, 0.0), Vec3::Y);
    }
}
