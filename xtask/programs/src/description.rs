//! Descriptions of programs for WebGPU's JavaScript API.

use std::collections::HashMap;

use antumbra::programs::CreatedObject;
use serde_json::{Map, Value, json};

/// Everything that was created, without duplicates. Modules and layouts are referred to by their indices in these lists.
#[derive(Debug, Default)]
pub struct Programs {
    modules: Listed<wgpu::ShaderModule>,
    bind_group_layouts: Listed<wgpu::BindGroupLayout>,
    pipeline_layouts: Listed<wgpu::PipelineLayout>,
    pipelines: Listed<()>,
}

/// Distinct descriptions, and the index of each object's description. Several objects can share one.
#[derive(Debug)]
struct Listed<T> {
    descriptions: Vec<Value>,
    /// Indices by the description's text.
    known: HashMap<String, usize>,
    things: HashMap<T, usize>,
}

impl<T> Default for Listed<T> {
    fn default() -> Self {
        Self { descriptions: Vec::new(), known: HashMap::new(), things: HashMap::new() }
    }
}

impl<T: Clone + Eq + std::hash::Hash> Listed<T> {
    fn add(&mut self, thing: &T, what: &Value, label: &str) {
        let index = *self.known.entry(what.to_string()).or_insert_with(|| {
            let mut description = json!({ "label": label });
            if let (Value::Object(all), Value::Object(what)) = (&mut description, what) {
                all.extend(what.clone());
            }
            self.descriptions.push(description);
            self.descriptions.len() - 1
        });
        self.things.insert(thing.clone(), index);
    }

    /// # Panics
    /// If the object was not recorded.
    fn place_of(&self, thing: &T) -> usize {
        *self.things.get(thing).expect("created by `antumbra::programs`, as all parts of a pipeline are")
    }
}

/// Entry point of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry<'a> {
    /// Index of the module.
    pub module: usize,
    /// `compute`, `vertex` or `fragment`.
    pub stage: &'a str,
    /// Name; `None` if it is the only entry point of its stage.
    pub name: Option<&'a str>,
}

impl Programs {
    /// Records a created object.
    pub fn add(&mut self, made: CreatedObject<'_>) {
        match made {
            CreatedObject::Module(module, label, wgsl) => self.modules.add(module, &json!({ "code": wgsl }), label),
            CreatedObject::BindGroupLayout(layout, entries) => {
                let entries: Vec<_> = entries.iter().map(bind_group_layout_entry).collect();
                self.bind_group_layouts.add(layout, &json!({ "entries": entries }), "");
            }
            CreatedObject::PipelineLayout(layout, groups) => {
                let groups: Vec<_> =
                    groups.iter().map(|group| group.map(|group| self.bind_group_layouts.place_of(group))).collect();
                self.pipeline_layouts.add(layout, &json!({ "bindGroupLayouts": groups }), "");
            }
            CreatedObject::Compute(descriptor) => {
                let wgpu::ComputePipelineDescriptor { module, entry_point, compilation_options, .. } = descriptor;
                let compute = self.stage(module, *entry_point, compilation_options);
                let what = json!({ "layout": self.layout(descriptor.layout), "compute": compute });
                self.pipelines.add(&(), &what, descriptor.label.unwrap_or_default());
            }
            CreatedObject::Render(descriptor) => {
                let what = self.render_pipeline(descriptor);
                self.pipelines.add(&(), &what, descriptor.label.unwrap_or_default());
            }
        }
    }

    /// Adds a module without a known pipeline.
    pub fn add_module(&mut self, label: &str, wgsl: &str) {
        if self.place_of_text(wgsl).is_none() {
            self.modules.descriptions.push(json!({ "label": label, "code": wgsl }));
        }
    }

    /// Returns the index of the module with a text.
    pub fn place_of_text(&self, wgsl: &str) -> Option<usize> {
        self.modules.descriptions.iter().position(|module| module["code"] == wgsl)
    }

    /// Returns the number of modules and of pipelines.
    pub fn counts(&self) -> [usize; 2] {
        [self.modules.descriptions.len(), self.pipelines.descriptions.len()]
    }

    /// Whether a pipeline uses an entry point.
    pub fn has_pipeline_of(&self, entry: Entry<'_>) -> bool {
        self.pipelines.descriptions.iter().any(|pipeline| {
            let stage = &pipeline[entry.stage];
            stage["module"].as_u64() == Some(entry.module as u64)
                && (stage["entryPoint"].is_null() || stage["entryPoint"].as_str() == entry.name)
        })
    }

    /// Returns all descriptions.
    pub fn into_json(self) -> Value {
        json!({
            "modules": self.modules.descriptions,
            "bindGroupLayouts": self.bind_group_layouts.descriptions,
            "pipelineLayouts": self.pipeline_layouts.descriptions,
            "pipelines": self.pipelines.descriptions,
        })
    }

    fn layout(&self, layout: Option<&wgpu::PipelineLayout>) -> usize {
        self.pipeline_layouts.place_of(layout.expect("all pipelines have explicit layouts"))
    }

    fn stage(
        &self,
        module: &wgpu::ShaderModule,
        entry_point: Option<&str>,
        options: &wgpu::PipelineCompilationOptions<'_>,
    ) -> Value {
        let constants: Map<_, _> =
            options.constants.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        let mut stage = json!({ "module": self.modules.place_of(module), "constants": constants });
        if let Some(entry_point) = entry_point {
            stage["entryPoint"] = json!(entry_point);
        }
        stage
    }

    fn render_pipeline(&self, descriptor: &wgpu::RenderPipelineDescriptor<'_>) -> Value {
        let wgpu::RenderPipelineDescriptor { vertex, primitive, multisample, .. } = descriptor;
        let mut vertex_stage = self.stage(vertex.module, vertex.entry_point, &vertex.compilation_options);
        vertex_stage["buffers"] = vertex.buffers.iter().map(|buffer| buffer.as_ref().map(vertex_buffer)).collect();
        let mut what = json!({
            "layout": self.layout(descriptor.layout),
            "vertex": vertex_stage,
            "primitive": {
                "topology": kebab(primitive.topology),
                "frontFace": kebab(primitive.front_face),
                "cullMode": primitive.cull_mode.map_or("none".into(), kebab),
                "unclippedDepth": primitive.unclipped_depth,
            },
            "multisample": {
                "count": multisample.count,
                "mask": multisample.mask as u32,
                "alphaToCoverageEnabled": multisample.alpha_to_coverage_enabled,
            },
        });
        if let Some(format) = primitive.strip_index_format {
            what["primitive"]["stripIndexFormat"] = name(format).into();
        }
        if let Some(fragment) = &descriptor.fragment {
            what["fragment"] = self.stage(fragment.module, fragment.entry_point, &fragment.compilation_options);
            what["fragment"]["targets"] =
                fragment.targets.iter().map(|target| target.as_ref().map(color_target)).collect();
        }
        if let Some(depth) = &descriptor.depth_stencil {
            what["depthStencil"] = depth_stencil(depth);
        }
        what
    }
}

fn vertex_buffer(buffer: &wgpu::VertexBufferLayout<'_>) -> Value {
    let attributes = buffer.attributes.iter().map(|attribute| {
        json!({
            "format": name(attribute.format),
            "offset": attribute.offset,
            "shaderLocation": attribute.shader_location,
        })
    });
    json!({
        "arrayStride": buffer.array_stride,
        "stepMode": kebab(buffer.step_mode),
        "attributes": attributes.collect::<Vec<_>>(),
    })
}

fn color_target(target: &wgpu::ColorTargetState) -> Value {
    let mut what = json!({ "format": format_name(target.format), "writeMask": target.write_mask.bits() });
    if let Some(blend) = target.blend {
        let component = |component: wgpu::BlendComponent| {
            json!({
                "srcFactor": kebab(component.src_factor),
                "dstFactor": kebab(component.dst_factor),
                "operation": kebab(component.operation),
            })
        };
        what["blend"] = json!({ "color": component(blend.color), "alpha": component(blend.alpha) });
    }
    what
}

fn depth_stencil(state: &wgpu::DepthStencilState) -> Value {
    let face = |face: wgpu::StencilFaceState| {
        json!({
            "compare": kebab(face.compare),
            "failOp": kebab(face.fail_op),
            "depthFailOp": kebab(face.depth_fail_op),
            "passOp": kebab(face.pass_op),
        })
    };
    let mut what = json!({
        "format": format_name(state.format),
        "stencilFront": face(state.stencil.front),
        "stencilBack": face(state.stencil.back),
        "stencilReadMask": state.stencil.read_mask,
        "stencilWriteMask": state.stencil.write_mask,
        "depthBias": state.bias.constant,
        "depthBiasSlopeScale": state.bias.slope_scale,
        "depthBiasClamp": state.bias.clamp,
    });
    if let Some(is_written) = state.depth_write_enabled {
        what["depthWriteEnabled"] = is_written.into();
    }
    if let Some(compare) = state.depth_compare {
        what["depthCompare"] = kebab(compare).into();
    }
    what
}

fn bind_group_layout_entry(entry: &wgpu::BindGroupLayoutEntry) -> Value {
    assert_eq!(entry.count, None, "WebGPU has no arrays of bindings");
    let mut what = json!({ "binding": entry.binding, "visibility": entry.visibility.bits() });
    let (kind, is) = match entry.ty {
        wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size } => {
            let ty = match ty {
                wgpu::BufferBindingType::Uniform => "uniform",
                wgpu::BufferBindingType::Storage { read_only: true } => "read-only-storage",
                wgpu::BufferBindingType::Storage { read_only: false } => "storage",
            };
            let least = min_binding_size.map_or(0, std::num::NonZeroU64::get);
            ("buffer", json!({ "type": ty, "hasDynamicOffset": has_dynamic_offset, "minBindingSize": least }))
        }
        wgpu::BindingType::Sampler(ty) => ("sampler", json!({ "type": kebab(ty) })),
        wgpu::BindingType::Texture { sample_type, view_dimension, multisampled } => {
            let ty = match sample_type {
                wgpu::TextureSampleType::Float { filterable: true } => "float",
                wgpu::TextureSampleType::Float { filterable: false } => "unfilterable-float",
                wgpu::TextureSampleType::Depth => "depth",
                wgpu::TextureSampleType::Sint => "sint",
                wgpu::TextureSampleType::Uint => "uint",
            };
            let dimension = dimension_name(view_dimension);
            ("texture", json!({ "sampleType": ty, "viewDimension": dimension, "multisampled": multisampled }))
        }
        wgpu::BindingType::StorageTexture { access, format, view_dimension } => {
            let (format, dimension) = (format_name(format), dimension_name(view_dimension));
            ("storageTexture", json!({ "access": kebab(access), "format": format, "viewDimension": dimension }))
        }
        ref other => panic!("WebGPU has no such binding: {other:?}"),
    };
    what[kind] = is;
    what
}

/// Returns the JavaScript name of a dimension: `2d-array` for `D2Array`.
fn dimension_name(dimension: wgpu::TextureViewDimension) -> String {
    let name = kebab(dimension);
    match name.strip_prefix('d') {
        Some(rest) => format!("{}d{}", &rest[..1], &rest[1..]),
        None => name,
    }
}

/// Returns the JavaScript name of a format: `rgba8unorm-srgb` for `Rgba8UnormSrgb`, `depth32float` for `Depth32Float`.
fn format_name(format: wgpu::TextureFormat) -> String {
    let name = name(format);
    ["srgb", "stencil8"].iter().fold(name, |name, end| match name.strip_suffix(end) {
        Some(begin) if !begin.is_empty() => format!("{begin}-{end}"),
        _ => name,
    })
}

/// Returns the name in lower case: `float32x3` for `Float32x3`.
fn name(of: impl std::fmt::Debug) -> String {
    format!("{of:?}").to_lowercase()
}

/// Returns the name in kebab case: `one-minus-src-alpha` for `OneMinusSrcAlpha`.
fn kebab(of: impl std::fmt::Debug) -> String {
    let mut name = String::new();
    for letter in format!("{of:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_webgpu() {
        let formats = [
            (wgpu::TextureFormat::Rgba8UnormSrgb, "rgba8unorm-srgb"),
            (wgpu::TextureFormat::Depth32Float, "depth32float"),
            (wgpu::TextureFormat::Depth24PlusStencil8, "depth24plus-stencil8"),
            (wgpu::TextureFormat::Stencil8, "stencil8"),
        ];
        for (format, expected) in formats {
            assert_eq!(format_name(format), expected);
        }
        assert_eq!(dimension_name(wgpu::TextureViewDimension::D2Array), "2d-array");
        assert_eq!(dimension_name(wgpu::TextureViewDimension::CubeArray), "cube-array");
        assert_eq!(kebab(wgpu::BlendFactor::OneMinusSrcAlpha), "one-minus-src-alpha");
        assert_eq!(kebab(wgpu::SamplerBindingType::NonFiltering), "non-filtering");
        assert_eq!(kebab(wgpu::PrimitiveTopology::TriangleList), "triangle-list");
        assert_eq!(kebab(wgpu::StorageTextureAccess::ReadWrite), "read-write");
        assert_eq!(name(wgpu::VertexFormat::Float32x3), "float32x3");
    }
}
