//! Invalid input: every technique refuses it in one line that names the problem and valid values, before anything is recorded.

use antumbra::casters::{Caster, Indices, InstanceBuffer, Instances, Mesh as LibraryMesh, PositionFormat, Positions};
use antumbra::light::{Aabb, Light, LightShape, ShadowDistance};
use antumbra::techniques::single_map::pcss::{Pcss, PcssParams};
use antumbra::{
    AnyShadow, CasterSet, Casters, Denoise, DepthConvention, DepthMapCaster, Error, Frame, Mask, MaskChannels,
    MaskPlace, MeshCaster, Receivers, Shadow, TechniqueKind,
};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, draw, in_buffer, mask_of, matrix_buffer, small_shadow};
use antumbra_host_tests::raster::{Picture, texture};
use antumbra_host_tests::scene::{Camera, Mesh, Object, Scene, base_light};
use glam::{Mat4, UVec2, Vec3};
use wgpu::TextureFormat as Format;

const SIZE: UVec2 = UVec2::new(16, 9);

/// A frame that every technique accepts.
struct Good {
    device: &'static Device,
    picture: Picture,
    casters: HostCasters,
    light: Light,
    mask: Mask,
    shadows: Vec<AnyShadow>,
}

impl Good {
    fn new() -> Option<Self> {
        let device = Device::shared()?;
        let scene = Scene::base(10.0);
        Some(Self {
            device,
            picture: Picture::draw(device, &scene, &Camera { size_px: SIZE, ..Camera::base() }),
            casters: HostCasters::new(device, &scene),
            light: base_light(),
            mask: Mask::new(device.wgpu(), SIZE),
            shadows: TechniqueKind::ALL.iter().map(|kind| small_shadow(device, *kind)).collect(),
        })
    }

    fn frame(&self) -> Frame<'_> {
        Frame { light: &self.light, casters: self.casters.all(), receivers: self.picture.receivers(), mask: &self.mask }
    }

    /// Checks that every technique refuses the changed frame in one line that contains all `words`.
    fn is_refused(&mut self, words: &[&str], change: impl for<'a> Fn(Frame<'a>) -> Frame<'a>) {
        let mut shadows = std::mem::take(&mut self.shadows);
        for shadow in &mut shadows {
            let kind = shadow.kind();
            let what = format!("{kind}, {words:?}");
            let error = self.device.validated(&what, || shadow.prepare(&change(self.frame())).map(drop));
            let error = error.expect_err(&what).to_string();
            assert!(error.starts_with(&format!("{kind}: ")) && !error.contains('\n'), "{error}");
            assert!(words.iter().all(|word| error.contains(word)), "{error}: not {words:?}");
        }
        self.shadows = shadows;
    }
}

/// Creates a texture of the receivers' size and returns its view.
fn view(device: &Device, format: Format, usage: wgpu::TextureUsages) -> wgpu::TextureView {
    texture(device, SIZE, 1, format, usage).create_view(&wgpu::TextureViewDescriptor::default())
}

#[test]
fn lights_and_cameras() {
    let Some(mut good) = Good::new() else { return };
    let none = Light { shape: LightShape::Points { positions_m: Vec::new() }, ..good.light.clone() };
    let nowhere = Light { center: Vec3::NAN, ..good.light.clone() };
    for (light, words) in [(&none, ["`positions`", "at least one position"]), (&nowhere, ["`center`", "finite"])] {
        let light: &'static Light = Box::leak(Box::new(light.clone()));
        good.is_refused(&words, |frame| Frame { light, ..frame });
    }
    let seen_by = |good: &mut Good, words: &[&str], change: fn(&mut Receivers<'_>)| {
        good.is_refused(words, |mut frame| {
            change(&mut frame.receivers);
            frame
        });
    };
    seen_by(&mut good, &["the receivers' size"], |it| it.size_px = UVec2::new(16, 0));
    seen_by(&mut good, &["the mask's size", "[8, 9]"], |it| it.size_px = UVec2::new(8, 9));
    seen_by(&mut good, &["the depth buffer"], |it| it.origin_px = UVec2::new(1, 0));
    seen_by(&mut good, &["the camera's pose", "not finite"], |it| it.view_from_world = Mat4::NAN);
    seen_by(&mut good, &["the camera's pose", "not rigid"], |it| {
        it.view_from_world = Mat4::from_scale(Vec3::splat(2.0)) * it.view_from_world;
    });
    seen_by(&mut good, &["the camera's matrix", "singular"], |it| it.clip_from_view = Mat4::ZERO);
    seen_by(&mut good, &["the depth convention", "Reversed, as in the projection"], |it| {
        it.depth_convention = DepthConvention::Standard;
    });
    seen_by(&mut good, &["the receivers' bounding box", "not a number"], |it| {
        it.bounds = Some(Aabb { min: Vec3::NAN, max: Vec3::ONE });
    });
    seen_by(&mut good, &["the receivers' bounding box", "empty"], |it| {
        it.bounds = Some(Aabb { min: Vec3::ONE, max: Vec3::ZERO });
    });
    seen_by(&mut good, &["`hull`", "point 1"], |it| it.hull = &[Vec3::ZERO, Vec3::NAN, Vec3::X]);
    seen_by(&mut good, &["`seen`", "point 0"], |it| it.seen = &[Vec3::INFINITY]);
    seen_by(&mut good, &["shadow distance"], |it| {
        it.shadow_distance = Some(ShadowDistance { end_m: f32::NAN, fade_m: 1.0 });
    });
    // Empty and infinite bounds of receivers are valid.
    for bounds in [Aabb::EMPTY, Aabb::EVERYTHING] {
        let receivers = good.picture.receivers().with_bounds(bounds);
        mask_of(
            good.device,
            &mut small_shadow(good.device, TechniqueKind::Hard),
            &good.light,
            good.casters.all(),
            receivers,
        );
    }
}

#[test]
fn textures() {
    let Some(mut good) = Good::new() else { return };
    let device = good.device;
    let bound = wgpu::TextureUsages::TEXTURE_BINDING;
    let layers = texture(device, SIZE, 2, Format::Depth32Float, bound);
    let array = layers.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..wgpu::TextureViewDescriptor::default()
    });
    let other = device.another();
    let depths: [(wgpu::TextureView, &[&str]); 6] = [
        (view(device, Format::Depth16Unorm, bound), &["the depth buffer", "Depth16Unorm", "16 bits"]),
        (view(device, Format::Rgba8Unorm, bound), &["the depth buffer", "Rgba8Unorm", "Depth32Float or R32Float"]),
        (view(device, Format::Depth32Float, wgpu::TextureUsages::empty()), &["the depth buffer", "TEXTURE_BINDING"]),
        (view(device, Format::Depth24PlusStencil8, bound), &["the depth buffer", "only the depth aspect"]),
        (array, &["the depth buffer", "D2Array"]),
        (view(&other, Format::Depth32Float, bound), &["the depth buffer", "cannot be bound"]),
    ];
    for (depth, words) in &depths {
        good.is_refused(words, |frame| Frame { receivers: in_depth_of(frame.receivers, long(depth)), ..frame });
    }
    let half = texture(device, SIZE / 2, 1, Format::Rgba16Float, bound);
    let normals: [(wgpu::TextureView, &[&str]); 4] = [
        (half.create_view(&wgpu::TextureViewDescriptor::default()), &["the normals' texture", "[8, 4]", "[16, 9]"]),
        (view(device, Format::Rgba8Unorm, bound), &["the normals' texture", "Rgba8Unorm", "signed"]),
        (view(device, Format::Rgba16Float, wgpu::TextureUsages::empty()), &["the normals' texture", "TEXTURE_BINDING"]),
        (view(&other, Format::Rgba16Float, bound), &["the normals' texture", "cannot be bound"]),
    ];
    for (normals, words) in &normals {
        good.is_refused(words, |frame| Frame { receivers: frame.receivers.with_normals(long(normals)), ..frame });
    }
    let elsewhere = Mask::new(other.wgpu(), SIZE);
    good.is_refused(&["the mask", "cannot be bound"], |frame| Frame { mask: long(&elsewhere), ..frame });
    let in_depth = texture(device, SIZE, 1, Mask::FORMAT, Mask::usages(Mask::FORMAT));
    let depth = in_depth.create_view(&wgpu::TextureViewDescriptor::default());
    let mask = Mask::of_layers(&in_depth, 0, MaskChannels::One).expect("a mask's texture");
    good.is_refused(&["the mask", "in a separate texture"], |frame| Frame {
        mask: long(&mask),
        receivers: in_depth_of(frame.receivers, long(&depth)),
        ..frame
    });
    let wrong =
        Denoise { motion: Some(half.create_view(&wgpu::TextureViewDescriptor::default())), ..Denoise::default() };
    for (denoise, words) in [
        (Denoise { max_frames: 0, motion: None }, "the denoiser's `max_frames` is 0, and must be 1 to 64"),
        (wrong, "the motion vectors' texture is [8, 4] texels large"),
    ] {
        let mut shadow = small_shadow(device, TechniqueKind::Pcss);
        shadow.set_denoise(Some(denoise));
        let error = shadow.prepare(&good.frame()).map(drop).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// The receivers, in another depth buffer.
fn in_depth_of<'a>(mut receivers: Receivers<'a>, depth: &'a wgpu::TextureView) -> Receivers<'a> {
    receivers.depth = depth;
    receivers
}

/// Textures and places in them that no mask can have.
#[test]
fn masks_in_textures() {
    let Some(good) = Good::new() else { return };
    let device = good.device;
    let format = Mask::FORMAT;
    let of = |format, usage| texture(device, SIZE, 2, format, usage);
    let whole = |texture: &wgpu::Texture| MaskPlace::layer(texture, 0);
    let fits = of(format, Mask::usages(format));
    let four = of(Format::Rgba8Unorm, Mask::usages(Format::Rgba8Unorm));
    let place = whole(&fits);
    let bad: [(&wgpu::Texture, MaskPlace, MaskChannels, &[&str]); 6] = [
        (
            &of(Format::Rgba32Float, Mask::usages(format)),
            place,
            MaskChannels::One,
            &["format", "Rgba32Float", "R32Float"],
        ),
        (&of(format, wgpu::TextureUsages::TEXTURE_BINDING), place, MaskChannels::One, &["usage", "STORAGE_BINDING"]),
        (&fits, MaskPlace { layer: 2, ..place }, MaskChannels::One, &["last layer is 2", "number of layers, 2"]),
        (&fits, place, MaskChannels::Three, &["last layer is 2", "number of layers, 2"]),
        (&fits, MaskPlace { origin_px: UVec2::new(1, 0), ..place }, MaskChannels::One, &["far corner", "[17, 9]"]),
        (
            &four,
            MaskPlace { component: 4, ..whole(&four) },
            MaskChannels::One,
            &["component is 4", "number of components, 4"],
        ),
    ];
    for (texture, place, channels, words) in bad {
        let message = Mask::within(texture, place, channels).expect_err("no mask").to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    Mask::within(&four, MaskPlace { component: 3, layer: 1, ..whole(&four) }, MaskChannels::One)
        .expect("in the texture");
}

/// Leaks a copy, because the changed frame borrows for any lifetime.
fn long<T: Clone>(value: &T) -> &'static T {
    Box::leak(Box::new(value.clone()))
}

#[test]
fn casters_of_a_frame() {
    let Some(mut good) = Good::new() else { return };
    let device = good.device;
    // Devices of the same instance and of another; objects of both have the same identifiers.
    for other in [Some(device.another()), Device::new()].into_iter().flatten() {
        let of_other: &'static HostCasters = Box::leak(Box::new(HostCasters::new(&other, &Scene::base(10.0))));
        good.is_refused(&["the set of casters", "another device"], |frame| Frame { casters: of_other.all(), ..frame });
    }

    let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::INDEX | wgpu::BufferUsages::STORAGE;
    let buffer: &'static wgpu::Buffer = Box::leak(Box::new(device.buffer(&[0; 144], usage)));
    let unusable: &'static wgpu::Buffer = Box::leak(Box::new(device.buffer(&[0; 144], wgpu::BufferUsages::STORAGE)));
    let of = |positions, indices, index_count| {
        MeshCaster::new(positions, indices, index_count, buffer).with_bounds(Aabb { min: Vec3::ZERO, max: Vec3::ONE })
    };
    let mesh = of(buffer, buffer, 3);
    let bad: [(MeshCaster<'static>, &[&str]); 7] = [
        (mesh.with_bounds(Aabb::EMPTY), &["`bounds`", "empty", "caster 1"]),
        (mesh.with_bounds(Aabb { min: Vec3::NAN, ..mesh.bounds }), &["`bounds`", "not a number"]),
        (of(buffer, buffer, 4), &["`index_count`", "a multiple of three"]),
        (mesh.with_first_triangle(12), &["index buffer", "144 bytes long", "at least 156"]),
        (mesh.with_instances(2..3), &["instance buffer", "144 bytes long", "at least 192"]),
        (of(unusable, buffer, 3), &["position buffer", "VERTEX", "caster 1"]),
        (of(buffer, unusable, 3), &["index buffer", "INDEX", "caster 1"]),
    ];
    for (caster, words) in bad {
        let casters: &'static [MeshCaster<'static>] = Box::leak(Box::new([mesh, caster]));
        good.is_refused(words, |frame| Frame { casters: Casters::Meshes(casters), ..frame });
    }

    let map = |format, usage| long(&view(device, format, usage));
    let depth_map = DepthMapCaster {
        view: map(Format::Depth32Float, wgpu::TextureUsages::TEXTURE_BINDING),
        size_px: SIZE,
        clip_from_world: Mat4::IDENTITY,
        depth_convention: DepthConvention::Reversed,
    };
    let unbound = map(Format::Depth32Float, wgpu::TextureUsages::empty());
    let color = map(Format::R32Float, wgpu::TextureUsages::TEXTURE_BINDING);
    let bad: [(DepthMapCaster<'static>, &[&str]); 3] = [
        (DepthMapCaster { view: unbound, ..depth_map }, &["the light's depth map", "TEXTURE_BINDING"]),
        (DepthMapCaster { view: color, ..depth_map }, &["the light's depth map", "R32Float"]),
        (DepthMapCaster { size_px: UVec2::splat(64), ..depth_map }, &["`size_px`", "[16, 9]"]),
    ];
    for (map, words) in bad {
        good.is_refused(words, |frame| Frame { casters: Casters::DepthMap(map), ..frame });
    }
}

/// A set refuses invalid meshes, instances and surfaces.
#[test]
fn casters_of_a_set() {
    let Some(device) = Device::shared() else { return };
    let mut set = CasterSet::new(&device.gpu);
    let source = device.buffer(&[0; 256], wgpu::BufferUsages::STORAGE);
    let mesh = LibraryMesh {
        vertex_count: 4,
        positions: Positions { buffer: &source, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
        texture_coordinates: None,
        indices: None,
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        closed: false,
        bounds: Aabb { min: Vec3::ZERO, max: Vec3::ONE },
    };
    let expect = |outcome: Result<(), Error>, words: &[&str]| {
        let error = outcome.expect_err("refused").to_string();
        assert!(error.starts_with("casters: ") && words.iter().all(|word| error.contains(word)), "{error}: {words:?}");
    };
    use wgpu::PrimitiveTopology as Topology;
    for (mesh, words) in [
        (LibraryMesh { topology: Topology::TriangleList, ..mesh }, ["the number of indices is 4", "multiple of three"]),
        (LibraryMesh { topology: Topology::PointList, ..mesh }, ["PointList", "TriangleList or TriangleStrip"]),
        (
            LibraryMesh { bounds: Aabb::EMPTY, ..mesh },
            ["the mesh's bounding box is empty", "first corner is the minimum"],
        ),
        (LibraryMesh { bounds: Aabb { min: Vec3::NAN, max: Vec3::ONE }, ..mesh }, ["not a number", "infinite bounds"]),
    ] {
        expect(set.add_mesh(&mesh).map(drop), &words);
    }
    let id = set.add_mesh(&mesh).expect("a strip");
    let placed = |bounds| InstanceBuffer { bounds, ..in_buffer(&source, 0, 2, None) };
    for (bounds, word) in [
        (Aabb::EMPTY, "empty"),
        (Aabb { min: Vec3::ONE, max: Vec3::ZERO }, "empty"),
        (Aabb { min: Vec3::NAN, max: Vec3::ONE }, "not a number"),
    ] {
        let instances = Instances::Buffer(placed(Some(bounds)));
        expect(set.add(&Caster::new(id, instances)).map(drop), &["the instances' bounding box", word]);
    }
    for bounds in [None, Some(Aabb::EVERYTHING), Some(Aabb { min: Vec3::splat(-1e6), max: Vec3::splat(1e6) })] {
        set.add(&Caster::new(id, Instances::Buffer(placed(bounds)))).expect("may be anywhere");
    }
}

#[test]
fn parameters_out_of_range() {
    let Some(good) = Good::new() else { return };
    let params = PcssParams { samples: 0, ..PcssParams::default() };
    let mut shadow = Shadow::<Pcss>::with_params(&good.device.gpu, params).expect("any device");
    let error = shadow.prepare(&good.frame()).map(drop).expect_err("no samples").to_string();
    assert!(error.contains("pcss: `samples` cannot be `0`"), "{error}");
}

/// A strip with a restart, with 16-bit or 32-bit indices or without indices, casts the same shadow as its triangle list.
#[test]
fn strips_cast_what_their_triangles_do() {
    let Some(device) = Device::shared() else { return };
    let camera = Camera { size_px: UVec2::new(48, 27), ..Camera::base() };
    let ground = Object::of(Mesh::ground(10.0));
    let picture = Picture::draw(device, &Scene { objects: vec![ground.clone()] }, &camera);
    // Two separate squares, and a vertex that would be visible if it were connected to them.
    let corner = |x: f32, z: f32| Vec3::new(x, 1.5, z);
    let mut positions = Vec::new();
    for x in [-2.0, 0.5] {
        positions.extend([corner(x, -1.0), corner(x, 1.0), corner(x + 1.2, -1.0), corner(x + 1.2, 1.0)]);
    }
    positions.push(Vec3::new(0.0, 1.5, 30.0));
    let strip = [0u32, 1, 2, 3, u32::MAX, 4, 5, 6, 7];
    let list = [0u32, 1, 2, 1, 2, 3, 4, 5, 6, 5, 6, 7];
    let unrolled: Vec<Vec3> = [0, 1, 2, 3, 3, 4, 4, 5, 6, 7].iter().map(|i: &usize| positions[*i]).collect();
    let usage = wgpu::BufferUsages::COPY_SRC;
    let narrow = strip.map(|i| i as u16);
    let [wide, narrow, list_buffer] =
        [bytemuck::cast_slice(&strip), bytemuck::cast_slice(&narrow), bytemuck::cast_slice(&list)]
            .map(|bytes: &[u8]| device.buffer(bytes, usage));
    let [indexed, plain] = [&positions, &unrolled].map(|points| device.buffer(bytemuck::cast_slice(points), usage));
    let indices = |buffer, format, count| Some(Indices { buffer, format, first_index: 0, count, base_vertex: 0 });
    use wgpu::PrimitiveTopology::{TriangleList, TriangleStrip};
    let shapes = [
        (&indexed, 9, TriangleList, indices(&list_buffer, wgpu::IndexFormat::Uint32, 12)),
        (&indexed, 9, TriangleStrip, indices(&wide, wgpu::IndexFormat::Uint32, 9)),
        (&indexed, 9, TriangleStrip, indices(&narrow, wgpu::IndexFormat::Uint16, 9)),
        (&plain, 10, TriangleStrip, None),
    ];
    let masks = shapes.map(|(buffer, vertex_count, topology, indices)| {
        let mut casters = HostCasters::new(device, &Scene { objects: vec![ground.clone()] });
        let mesh = LibraryMesh {
            vertex_count,
            positions: Positions { buffer, offset: 0, stride: 12, format: PositionFormat::Float32x3 },
            texture_coordinates: None,
            indices,
            topology,
            closed: topology == TriangleStrip,
            bounds: Aabb::of(positions[..8].iter().copied()),
        };
        let id = casters.set.add_mesh(&mesh).expect("a good mesh");
        casters.set.add(&Caster::new(id, Instances::Matrices(&[Mat4::IDENTITY]))).expect("a good caster");
        casters.update(device);
        ["hard", "sample_based"].map(|name| {
            let kind = TechniqueKind::from_name(name).expect("a technique");
            let mut shadow = small_shadow(device, kind);
            mask_of(device, &mut shadow, &base_light(), casters.all(), picture.receivers())
        })
    });
    assert!(masks[0].iter().all(|mask| mask.iter().filter(|v| **v < 0.5).count() > 20), "there are shadows");
    for (i, of_strip) in masks.iter().enumerate().skip(1) {
        assert!(of_strip == &masks[0], "strip {i}");
    }
}

/// A state draws correctly after refused frames.
#[test]
fn what_was_refused_leaves_nothing() {
    let Some(mut good) = Good::new() else { return };
    let mask = |shadow: &mut AnyShadow, good: &Good| {
        draw(good.device, shadow, &good.frame()).expect("a good frame");
        good.device.read_layer(good.mask.texture(), 0)
    };
    let mut shadow = small_shadow(good.device, TechniqueKind::Pcss);
    let before = mask(&mut shadow, &good);
    let light = std::mem::replace(&mut good.light, Light { center: Vec3::NAN, ..base_light() });
    assert!(shadow.prepare(&good.frame()).is_err());
    good.light = light;
    assert!(mask(&mut shadow, &good) == before);
    let buffer = matrix_buffer(good.device, &[Mat4::IDENTITY]);
    assert!(in_buffer(&buffer, 0, 1, None).bounds.is_none());
}
