//! The image and the interaction in it: camera, divider, light.

use antumbra_light::{Light, LightShape};
use antumbra_scene::Camera;
use glam::{UVec2, Vec2, Vec3};

use super::beam::{self, Handle};
use crate::camera;
use crate::state::{Angles, Show, State, move_by};

/// Rotation of the camera for a drag over the image's height, radians.
const TURN_RAD: f32 = std::f32::consts::PI;
/// Points of scrolling that halve the distance to the target.
const SCROLL_HALVING: f32 = 300.0;
/// Flight speed, scene diagonals per second.
const FLIGHT_DIAGONALS_S: f32 = 0.25;
/// Distance at which the pointer grabs the divider or the light, points.
const REACH: f32 = 8.0;
/// Distance of a drawn sun from the scene's centre, in scene diagonals.
const SUN_DIAGONALS: f32 = 0.5;
/// Number of corners of a round light's outline.
const OUTLINE_CORNERS: usize = 48;

/// Object of a drag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DragTarget {
    Divider,
    Light,
    Camera,
    Beam(Handle),
}

/// Position of the pointer over the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// Position on the screen, points.
    pub place: egui::Pos2,
    /// Position in the image from its top left, 0 to 1.
    pub unit: Vec2,
}

/// Shows the image, handles input, and draws divider and light over it. `map_lines` describe the sides' shadow maps or lists.
pub fn show(
    ui: &mut egui::Ui,
    state: &mut State,
    texture: Option<egui::TextureId>,
    map_lines: [Option<String>; 2],
) -> Option<Pointer> {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
    if let Some(texture) = texture {
        let uv = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        ui.painter_at(rect).image(texture, rect, uv, egui::Color32::WHITE);
    }
    state.scene.as_ref()?;
    drag(ui, state, &response, rect);
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            camera::zoom(&mut state.setup.camera, (-scroll / SCROLL_HALVING).exp2());
        }
    }
    if !ui.text_edit_focused() {
        fly(ui, state);
    }
    let painter = ui.painter_at(rect);
    if matches!(state.show, Show::LightMap | Show::Lists) {
        tell_of_maps(ui, &painter, state, rect, map_lines);
    } else {
        outline(&painter, state, rect);
    }
    if state.is_split {
        divider(ui, &painter, state, rect);
    }
    let place = response.hover_pos()?;
    let unit = (place - rect.min) / rect.size();
    Some(Pointer { place, unit: Vec2::new(unit.x, unit.y) })
}

/// Draws each side's description below its maps.
fn tell_of_maps(ui: &egui::Ui, painter: &egui::Painter, state: &State, rect: egui::Rect, lines: [Option<String>; 2]) {
    let x = if state.is_split { divider_x(state, rect) } else { rect.right() };
    let rooms = [(rect.left(), x), (x, rect.right())];
    for (line, (left, right)) in lines.into_iter().zip(rooms).filter(|(_, (left, right))| right > left) {
        let Some(line) = line else { continue };
        let font = egui::TextStyle::Body.resolve(ui.style());
        let galley = painter.layout(line, font, egui::Color32::WHITE, right - left - 20.0);
        let min = egui::pos2(0.5 * (left + right - galley.size().x), rect.bottom() - galley.size().y - 10.0);
        painter.rect_filled(
            egui::Rect::from_min_size(min, galley.size()).expand(4.0),
            3.0,
            egui::Color32::from_black_alpha(170),
        );
        painter.galley(min, galley, egui::Color32::WHITE);
    }
}

fn divider_x(state: &State, rect: egui::Rect) -> f32 {
    rect.left() + state.divider * rect.width()
}

fn drag(ui: &egui::Ui, state: &mut State, response: &egui::Response, rect: egui::Rect) {
    let hold_id = response.id.with("hold");
    if let Some(pointer) = response.hover_pos().filter(|_| state.is_split)
        && (pointer.x - divider_x(state, rect)).abs() < REACH
    {
        ui.set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
    }
    if response.drag_started() {
        let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(rect.center());
        ui.data_mut(|data| data.insert_temp(hold_id, hold_at(state, from, rect)));
    }
    // At low frame rates the last movement arrives together with the release.
    if !response.dragged() && !response.drag_stopped() {
        return;
    }
    let delta = ui.input(|input| input.pointer.delta());
    let hold = ui.data(|data| data.get_temp::<DragTarget>(hold_id));
    let by = Vec2::new(delta.x, delta.y) / rect.height();
    if by == Vec2::ZERO {
        return;
    }
    match hold {
        Some(DragTarget::Divider) => {
            if let Some(pointer) = response.interact_pointer_pos() {
                state.divider = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            }
        }
        Some(DragTarget::Beam(handle)) => {
            let (camera, diagonal_m) = (state.setup.camera, diagonal_of(state));
            if let Some(pointer) = response.interact_pointer_pos() {
                let light = &mut state.setup.lights[state.light];
                handle.drag(light, &camera, diagonal_m, pointer, |x| place_of(&camera, x, rect));
            }
        }
        Some(DragTarget::Light) => {
            let camera = state.setup.camera;
            let light = &mut state.setup.lights[state.light];
            if light.is_distant() {
                turn_sun(light, &camera, by);
            } else {
                drag_light(light, &camera, by);
            }
        }
        Some(DragTarget::Camera) | None => drag_camera(ui, &mut state.setup.camera, response, by),
    }
}

/// Returns the object at the pointer that a drag moves.
fn hold_at(state: &State, pointer: egui::Pos2, rect: egui::Rect) -> DragTarget {
    let light = place_of(&state.setup.camera, handle_of(state), rect);
    if state.is_split && (pointer.x - divider_x(state, rect)).abs() < REACH {
        DragTarget::Divider
    } else if light.is_some_and(|place| place.distance(pointer) < 1.5 * REACH) {
        DragTarget::Light
    } else if let Some(handle) = beam_at(state, pointer, rect) {
        DragTarget::Beam(handle)
    } else {
        DragTarget::Camera
    }
}

/// Pans, turns or orbits the camera, by the button and keys that are held.
fn drag_camera(ui: &egui::Ui, camera: &mut Camera, response: &egui::Response, by: Vec2) {
    let is_panning = ui.input(|input| input.modifiers.shift) || !response.dragged_by(egui::PointerButton::Primary);
    let is_looking = ui.input(|input| input.modifiers.ctrl);
    if is_panning {
        camera::pan(camera, by);
    } else if is_looking {
        camera::look(camera, -TURN_RAD * by.x, -TURN_RAD * by.y);
    } else {
        camera::orbit(camera, -TURN_RAD * by.x, -TURN_RAD * by.y);
    }
}

fn diagonal_of(state: &State) -> f32 {
    state.scene.as_ref().map_or(1.0, |open| open.bounds.diagonal())
}

/// Returns the handle of the selected light's cone or frustum within reach of a position.
fn beam_at(state: &State, from: egui::Pos2, rect: egui::Rect) -> Option<Handle> {
    let (light, camera) = (&state.setup.lights[state.light], &state.setup.camera);
    let off = |handle: &Handle| {
        let place = place_of(camera, handle.place(light, camera, diagonal_of(state))?, rect)?;
        Some(place.distance(from)).filter(|off| *off < 1.5 * REACH)
    };
    let near = Handle::ALL.into_iter().filter_map(|handle| Some((handle, off(&handle)?)));
    near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(handle, _)| handle)
}

/// Moves a light parallel to the image at its depth, so that it follows the pointer.
fn drag_light(light: &mut Light, camera: &Camera, by_heights: Vec2) {
    let axes = camera::axes(camera);
    let depth_m = (light.center - camera.eye).dot(axes.forward);
    let height_m = 2.0 * depth_m * (0.5 * camera.fov_y_rad).tan();
    move_by(light, height_m * (axes.right * by_heights.x - axes.up * by_heights.y));
}

/// Rotates a sun so that it follows the pointer: to the image's right and up.
fn turn_sun(light: &mut Light, camera: &Camera, by_heights: Vec2) {
    let mut angles = Angles::of(light);
    // Ahead of the camera the sun moves right for a falling azimuth, behind it for a rising one.
    let is_beyond = -light.axis.dot(camera::axes(camera).forward) > 0.0;
    angles.azimuth_rad += TURN_RAD * by_heights.x * if is_beyond { -1.0 } else { 1.0 };
    let zenith = std::f32::consts::FRAC_PI_2;
    angles.elevation_rad = (angles.elevation_rad - TURN_RAD * by_heights.y).clamp(-zenith, zenith);
    angles.give_to(light);
}

/// Position of the selected light's handle: its centre, or the direction of a sun from the scene's centre.
fn handle_of(state: &State) -> Vec3 {
    let light = &state.setup.lights[state.light];
    let Some(open) = state.scene.as_ref().filter(|_| light.is_distant()) else { return light.center };
    open.bounds.center() - light.axis * (SUN_DIAGONALS * open.bounds.diagonal())
}

/// Moves the camera while W, A, S, D, Q or E are pressed.
fn fly(ui: &egui::Ui, state: &mut State) {
    let (direction, seconds, is_fast) = ui.input(|input| {
        let axis = |positive, negative| {
            f32::from(u8::from(input.key_down(positive))) - f32::from(u8::from(input.key_down(negative)))
        };
        let direction = Vec3::new(
            axis(egui::Key::D, egui::Key::A),
            axis(egui::Key::E, egui::Key::Q),
            axis(egui::Key::W, egui::Key::S),
        );
        (direction, input.stable_dt.min(0.1), input.modifiers.shift)
    });
    if direction != Vec3::ZERO && !ui.input(|input| input.modifiers.command) {
        let diagonal_m = state.scene.as_ref().map_or(1.0, |open| open.bounds.diagonal());
        let speed_m_s = diagonal_m * FLIGHT_DIAGONALS_S * if is_fast { 4.0 } else { 1.0 };
        camera::fly(&mut state.setup.camera, direction * speed_m_s * seconds);
        ui.request_repaint();
    }
}

/// Projects a world position to the screen; `None` behind the camera.
fn place_of(camera: &Camera, x: Vec3, rect: egui::Rect) -> Option<egui::Pos2> {
    let size = UVec2::new(rect.width().max(1.0) as u32, rect.height().max(1.0) as u32);
    let clip = camera.clip_from_view(size) * camera.view_from_world() * x.extend(1.0);
    let ndc = clip.truncate() / clip.w;
    (clip.w > camera.near_m).then(|| {
        let unit = 0.5 * Vec2::new(ndc.x, -ndc.y) + 0.5;
        rect.min + egui::vec2(unit.x * rect.width(), unit.y * rect.height())
    })
}

/// Draws the selected light's shape, handle and direction.
fn outline(painter: &egui::Painter, state: &State, rect: egui::Rect) {
    let light = &state.setup.lights[state.light];
    let camera = &state.setup.camera;
    let place = |x: Vec3| place_of(camera, x, rect);
    let stroke = egui::Stroke::new(1.5, egui::Color32::from_rgb(255, 200, 60));
    for ring in rings(light) {
        for pair in ring.windows(2) {
            if let (Some(a), Some(b)) = (place(pair[0]), place(pair[1])) {
                painter.line_segment([a, b], stroke);
            }
        }
    }
    outline_beam(painter, state, rect, stroke);
    let handle = handle_of(state);
    let Some(center) = place(handle) else { return };
    painter.circle(center, 5.0, stroke.color.gamma_multiply(0.6), stroke);
    let ahead_m = match light.shape {
        LightShape::Rectangle { .. } | LightShape::Disk { .. } => (2.0 * light.bounding_radius()).max(0.2),
        LightShape::Sun { .. } => state.scene.as_ref().map_or(1.0, |open| 0.1 * open.bounds.diagonal()),
        LightShape::Sphere { .. } | LightShape::Ellipsoid { .. } | LightShape::Points { .. } => return,
    };
    if let Some(ahead) = place(handle + light.axis * ahead_m) {
        painter.line_segment([center, ahead], stroke);
    }
}

/// Draws the selected light's cone or frustum with its handles: filled for the outer angle, hollow for the inner.
fn outline_beam(painter: &egui::Painter, state: &State, rect: egui::Rect, stroke: egui::Stroke) {
    let (light, camera, diagonal_m) = (&state.setup.lights[state.light], &state.setup.camera, diagonal_of(state));
    let place = |x: Vec3| place_of(camera, x, rect);
    let thin = egui::Stroke::new(1.0, stroke.color.gamma_multiply(0.7));
    for line in beam::lines(light, diagonal_m) {
        for pair in line.windows(2) {
            if let (Some(a), Some(b)) = (place(pair[0]), place(pair[1])) {
                painter.line_segment([a, b], thin);
            }
        }
    }
    for handle in Handle::ALL {
        if let Some(place) = handle.place(light, camera, diagonal_m).and_then(place) {
            let fill = if handle == Handle::Inner { egui::Color32::BLACK } else { stroke.color };
            painter.rect(
                egui::Rect::from_center_size(place, egui::Vec2::splat(9.0)),
                1.0,
                fill,
                stroke,
                egui::StrokeKind::Middle,
            );
        }
    }
}

/// Closed outlines of a light's shape in world space.
fn rings(light: &Light) -> Vec<Vec<Vec3>> {
    let frame = light.frame();
    let at = |x: f32, y: f32, z: f32| frame.center + frame.right * x + frame.up * y + frame.axis * z;
    let ellipse = |a: Vec3, b: Vec3| -> Vec<Vec3> {
        let angles = (0..=OUTLINE_CORNERS).map(|i| std::f32::consts::TAU * i as f32 / OUTLINE_CORNERS as f32);
        angles.map(|angle| frame.center + a * angle.cos() + b * angle.sin()).collect()
    };
    match &light.shape {
        LightShape::Rectangle { size_m } => {
            let Vec2 { x, y } = 0.5 * *size_m;
            vec![vec![at(-x, -y, 0.0), at(x, -y, 0.0), at(x, y, 0.0), at(-x, y, 0.0), at(-x, -y, 0.0)]]
        }
        LightShape::Disk { radius_m } => vec![ellipse(frame.right * *radius_m, frame.up * *radius_m)],
        LightShape::Sphere { radius_m: r } => {
            let [a, b, c] = [frame.right * *r, frame.up * *r, frame.axis * *r];
            vec![ellipse(a, b), ellipse(b, c), ellipse(c, a)]
        }
        LightShape::Ellipsoid { radii_m: r } => {
            let [a, b, c] = [frame.right * r.x, frame.up * r.y, frame.axis * r.z];
            vec![ellipse(a, b), ellipse(b, c), ellipse(c, a)]
        }
        LightShape::Sun { .. } => Vec::new(),
        LightShape::Points { positions_m } => {
            let cross = |p: &Vec3| Vec3::AXES.map(|axis| vec![*p - 0.05 * axis, *p + 0.05 * axis]);
            positions_m.iter().flat_map(cross).collect()
        }
    }
}

/// Draws the divider, its handle, and the names of the sides.
fn divider(ui: &egui::Ui, painter: &egui::Painter, state: &State, rect: egui::Rect) {
    let x = divider_x(state, rect);
    // White with a dark rim is visible on any background.
    let rim = egui::Color32::from_black_alpha(160);
    painter.vline(x, rect.y_range(), egui::Stroke::new(4.0, rim));
    painter.circle_filled(egui::pos2(x, rect.center().y), 7.0, rim);
    painter.vline(x, rect.y_range(), egui::Stroke::new(2.0, egui::Color32::WHITE));
    painter.circle_filled(egui::pos2(x, rect.center().y), 6.0, egui::Color32::WHITE);
    let aligns = [egui::Align2::RIGHT_TOP, egui::Align2::LEFT_TOP];
    for ((side, align), offset) in state.sides.iter().zip(aligns).zip([-10.0, 10.0]) {
        let font = egui::TextStyle::Heading.resolve(ui.style());
        let place = egui::pos2(x + offset, rect.top() + 8.0);
        let galley = painter.layout_no_wrap(side.name(), font, egui::Color32::WHITE);
        let text = align.anchor_size(place, galley.size());
        painter.rect_filled(text.expand(4.0), 3.0, egui::Color32::from_black_alpha(150));
        painter.galley(text.min, galley, egui::Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dragged_light_stays_under_the_hand() {
        let camera = Camera {
            eye: Vec3::new(3.0, 2.0, 6.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_rad: 0.8,
            near_m: 0.05,
            far_m: 100.0,
            shadow_distance: None,
        };
        let rect = egui::Rect::from_min_size(egui::pos2(10.0, 20.0), egui::vec2(800.0, 400.0));
        let shape = LightShape::Rectangle { size_m: Vec2::ONE };
        let mut light = Light::new(shape, Vec3::new(0.5, 3.0, 0.5), Vec3::ZERO);
        let before = place_of(&camera, light.center, rect).unwrap();
        drag_light(&mut light, &camera, Vec2::new(40.0, 20.0) / rect.height());
        let moved = place_of(&camera, light.center, rect).unwrap() - before;
        assert!((moved - egui::vec2(40.0, 20.0)).length() < 0.1, "{moved:?}");
        assert_eq!(place_of(&camera, camera.eye + Vec3::new(3.0, 2.0, 6.0), rect), None);

        // A sun ahead of the camera or behind it moves right and up with the pointer.
        for from in [Vec3::new(-1.0, 1.5, -2.0), Vec3::new(1.0, 1.5, 2.0)] {
            let mut sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.01 }, from, Vec3::ZERO);
            let axes = camera::axes(&camera);
            let on_screen = |sun: &Light| Vec2::new(-sun.axis.dot(axes.right), -sun.axis.dot(Vec3::Y));
            let before = on_screen(&sun);
            turn_sun(&mut sun, &camera, Vec2::new(0.01, -0.01));
            assert!(on_screen(&sun).cmpgt(before).all(), "{from}: {before} to {}", on_screen(&sun));
        }
    }
}
