//! Lights of every kind above moving objects. The window's title shows the technique and its cost.
//!
//! ```text
//! cargo run --release --features window --example showcase
//! ```
//!
//! `T` selects the next technique and `Q` the next quality. `N` switches between Bevy's own shadows and soft shadows.

mod scene;

use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy_antumbra::{AntumbraPlugin, NoSoftShadows, ShadowCounts, ShadowQuality, ShadowTechnique, SoftShadows};

/// Techniques that `T` cycles through.
const TECHNIQUES: [ShadowTechnique; 8] = [
    ShadowTechnique::Pcss,
    ShadowTechnique::Essm,
    ShadowTechnique::Evssm,
    ShadowTechnique::Mssm,
    ShadowTechnique::MultiLayer,
    ShadowTechnique::Reprojection,
    ShadowTechnique::SampleBased,
    ShadowTechnique::Hard,
];
const QUALITIES: [ShadowQuality; 4] =
    [ShadowQuality::Fast, ShadowQuality::Balanced, ShadowQuality::High, ShadowQuality::Best];

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, FrameTimeDiagnosticsPlugin::default(), AntumbraPlugin::default()))
        .add_systems(Startup, (scene::spawn, spawn_camera))
        .add_systems(Update, (scene::turn, scene::glide, choose, say))
        .run();
}

/// Settings of a camera apply to all lights without settings of their own.
fn spawn_camera(mut commands: Commands) {
    commands.spawn((Camera3d::default(), scene::camera(), SoftShadows::default()));
}

type AnyLight = Or<(With<PointLight>, With<SpotLight>, With<DirectionalLight>, With<RectLight>)>;

fn choose(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    mut settings: Single<&mut SoftShadows, With<Camera3d>>,
    lights: Query<(Entity, Has<NoSoftShadows>), AnyLight>,
) {
    if keys.just_pressed(KeyCode::KeyT) {
        settings.technique = after(&TECHNIQUES, settings.technique);
    }
    if keys.just_pressed(KeyCode::KeyQ) {
        settings.quality = after(&QUALITIES, settings.quality);
    }
    if keys.just_pressed(KeyCode::KeyN) {
        for (light, is_left_alone) in &lights {
            if is_left_alone {
                commands.entity(light).remove::<NoSoftShadows>();
            } else {
                commands.entity(light).insert(NoSoftShadows);
            }
        }
    }
}

fn after<T: Copy + PartialEq>(all: &[T], one: T) -> T {
    let i = all.iter().position(|of| *of == one).map_or(0, |i| i + 1);
    all[i % all.len()]
}

fn say(
    diagnostics: Res<DiagnosticsStore>,
    counts: Res<ShadowCounts>,
    settings: Single<&SoftShadows, With<Camera3d>>,
    mut window: Single<&mut Window>,
) {
    let frame_ms = diagnostics.get(&FrameTimeDiagnosticsPlugin::FRAME_TIME).and_then(|time| time.smoothed());
    let counts = counts.get();
    window.title = format!(
        "{} {:?}: {:.1} ms per frame, {:.2} ms of CPU time for the shadows of {} lights and {} casters",
        settings.technique.kind().title(),
        settings.quality,
        frame_ms.unwrap_or_default(),
        counts.processor_time.as_secs_f64() * 1e3,
        counts.lights,
        counts.casters,
    );
}
