//! Shadow of one light by a technique chosen at run time.

use std::fmt;

use super::{Frame, PointFrame, Prepared, Shadow, WarmUp, WarmUpSteps};
use crate::contract::{
    CastersKey, Denoise, DrawnLists, DrawnMap, Error, Overflow, ParamError, ParamSpec, ParamValue, Params, Quality,
};
use crate::gpu::ShaderFunction;
use crate::techniques::Technique;

/// Object-safe form of [`Shadow`].
trait ErasedShadow: wgpu::WasmNotSendSync {
    fn param_specs(&self) -> &'static [ParamSpec];
    fn get(&self, key: &str) -> Option<ParamValue>;
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError>;
    fn set_value(&mut self, key: &str, value: ParamValue) -> Result<(), ParamError>;
    fn set_quality(&mut self, quality: Quality);
    fn denoise(&self) -> Option<&Denoise>;
    fn set_denoise(&mut self, denoise: Option<Denoise>);
    fn half_resolution(&self) -> bool;
    fn set_half_resolution(&mut self, is_half: bool);
    fn warm_up(&self, what: WarmUp) -> Result<(), Error>;
    fn warm_up_steps(&self, what: WarmUp) -> WarmUpSteps;
    fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error>;
    fn prepare_points<'a>(&'a mut self, frame: &PointFrame<'a>) -> Result<Prepared<'a>, Error>;
    fn shader_function(&mut self, group: u32, prefix: &str) -> Result<ShaderFunction, Error>;
    fn memory_bytes(&self) -> u64;
    fn auto_map_sizes(&self) -> Vec<u32>;
    fn drawn_maps(&self) -> Vec<DrawnMap>;
    fn drawn_lists(&self) -> Vec<DrawnLists>;
    fn overflow(&self) -> Option<Overflow>;
    fn holds(&self, frame: &Frame<'_>, casters: Option<CastersKey>) -> bool;
    fn is_intact(&self) -> bool;
    fn map_texels(&self) -> u64;
}

impl<T: Technique + 'static> ErasedShadow for Shadow<T> {
    fn param_specs(&self) -> &'static [ParamSpec] {
        T::Params::specs()
    }
    fn get(&self, key: &str) -> Option<ParamValue> {
        self.params.get(key)
    }
    fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.params.set(T::NAME, key, text)
    }
    fn set_value(&mut self, key: &str, value: ParamValue) -> Result<(), ParamError> {
        self.params.set_value(T::NAME, key, value)
    }
    fn set_quality(&mut self, quality: Quality) {
        self.params = T::Params::of_quality(quality);
    }
    fn denoise(&self) -> Option<&Denoise> {
        self.denoise.as_ref()
    }
    fn set_denoise(&mut self, denoise: Option<Denoise>) {
        self.denoise = denoise;
    }
    fn half_resolution(&self) -> bool {
        self.half_resolution
    }
    fn set_half_resolution(&mut self, is_half: bool) {
        self.half_resolution = is_half;
    }
    fn warm_up(&self, what: WarmUp) -> Result<(), Error> {
        Shadow::warm_up(self, what)
    }
    fn warm_up_steps(&self, what: WarmUp) -> WarmUpSteps {
        Shadow::warm_up_steps(self, what)
    }
    fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        Shadow::prepare(self, frame)
    }
    fn prepare_points<'a>(&'a mut self, frame: &PointFrame<'a>) -> Result<Prepared<'a>, Error> {
        Shadow::prepare_points(self, frame)
    }
    fn shader_function(&mut self, group: u32, prefix: &str) -> Result<ShaderFunction, Error> {
        Shadow::shader_function(self, group, prefix)
    }
    fn memory_bytes(&self) -> u64 {
        Shadow::memory_bytes(self)
    }
    fn auto_map_sizes(&self) -> Vec<u32> {
        Shadow::auto_map_sizes(self)
    }
    fn drawn_maps(&self) -> Vec<DrawnMap> {
        Shadow::drawn_maps(self)
    }
    fn drawn_lists(&self) -> Vec<DrawnLists> {
        Shadow::drawn_lists(self)
    }
    fn overflow(&self) -> Option<Overflow> {
        Shadow::overflow(self)
    }
    fn holds(&self, frame: &Frame<'_>, casters: Option<CastersKey>) -> bool {
        Shadow::holds(self, frame, casters)
    }
    fn is_intact(&self) -> bool {
        Shadow::is_intact(self)
    }
    fn map_texels(&self) -> u64 {
        Shadow::map_texels(self)
    }
}

/// State of one light's shadow, by a technique chosen at run time.
pub struct AnyShadow {
    technique: &'static str,
    inner: Box<dyn ErasedShadow>,
}

impl fmt::Debug for AnyShadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyShadow({})", self.technique)
    }
}

impl<T: Technique + 'static> From<Shadow<T>> for AnyShadow {
    fn from(shadow: Shadow<T>) -> Self {
        Self { technique: T::NAME, inner: Box::new(shadow) }
    }
}

impl AnyShadow {
    /// Name of the technique.
    pub fn name(&self) -> &'static str {
        self.technique
    }

    /// Parameters with their current values.
    pub fn params(&self) -> impl Iterator<Item = (&'static ParamSpec, ParamValue)> + '_ {
        self.inner.param_specs().iter().map(|spec| (spec, self.inner.get(spec.key).unwrap_or(spec.default)))
    }

    /// Sets a parameter from text, for the next frame.
    ///
    /// # Errors
    /// Lists the technique's keys, or the values that the key accepts.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), ParamError> {
        self.inner.set(key, text)
    }

    /// Sets a parameter to a value of its type, for the next frame: `set_value("map_size", 2048)`. Give a choice by its name.
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn set_value(&mut self, key: &str, value: impl Into<ParamValue>) -> Result<(), ParamError> {
        self.inner.set_value(key, value.into())
    }

    /// Sets all parameters to a quality's values, for the next frame. Set single ones afterwards.
    pub fn set_quality(&mut self, quality: Quality) {
        self.inner.set_quality(quality);
    }

    /// Denoiser settings of the next frame; `None` without a denoiser.
    pub fn denoise(&self) -> Option<&Denoise> {
        self.inner.denoise()
    }

    /// Sets the denoiser of the next frame; `None` disables it.
    pub fn set_denoise(&mut self, denoise: Option<Denoise>) {
        self.inner.set_denoise(denoise);
    }

    /// Whether the next frame's technique writes a mask of half the width and height.
    pub fn half_resolution(&self) -> bool {
        self.inner.half_resolution()
    }

    /// Sets whether the next frame's technique writes a mask of half the width and height.
    pub fn set_half_resolution(&mut self, is_half: bool) {
        self.inner.set_half_resolution(is_half);
    }

    /// [`Shadow::warm_up`].
    ///
    /// # Errors
    /// As [`Shadow::warm_up`].
    pub fn warm_up(&self, what: WarmUp) -> Result<(), Error> {
        self.inner.warm_up(what)
    }

    /// [`Shadow::warm_up_steps`].
    pub fn warm_up_steps(&self, what: WarmUp) -> WarmUpSteps {
        self.inner.warm_up_steps(what)
    }

    /// [`Shadow::prepare`].
    ///
    /// # Errors
    /// As [`Shadow::prepare`].
    pub fn prepare<'a>(&'a mut self, frame: &Frame<'a>) -> Result<Prepared<'a>, Error> {
        self.inner.prepare(frame)
    }

    /// [`Shadow::prepare_points`].
    ///
    /// # Errors
    /// As [`Shadow::prepare_points`].
    pub fn prepare_points<'a>(&'a mut self, frame: &PointFrame<'a>) -> Result<Prepared<'a>, Error> {
        self.inner.prepare_points(frame)
    }

    /// [`Shadow::shader_function`].
    ///
    /// # Errors
    /// As [`Shadow::shader_function`].
    pub fn shader_function(&mut self, group: u32, prefix: &str) -> Result<ShaderFunction, Error> {
        self.inner.shader_function(group, prefix)
    }

    /// [`Shadow::memory_bytes`].
    pub fn memory_bytes(&self) -> u64 {
        self.inner.memory_bytes()
    }

    /// [`Shadow::auto_map_sizes`].
    pub fn auto_map_sizes(&self) -> Vec<u32> {
        self.inner.auto_map_sizes()
    }

    /// [`Shadow::drawn_maps`].
    pub fn drawn_maps(&self) -> Vec<DrawnMap> {
        self.inner.drawn_maps()
    }

    /// [`Shadow::drawn_lists`].
    pub fn drawn_lists(&self) -> Vec<DrawnLists> {
        self.inner.drawn_lists()
    }

    /// [`Shadow::overflow`].
    pub fn overflow(&self) -> Option<Overflow> {
        self.inner.overflow()
    }

    /// [`Shadow::holds`].
    pub(crate) fn holds(&self, frame: &Frame<'_>, casters: Option<CastersKey>) -> bool {
        self.inner.holds(frame, casters)
    }

    /// [`Shadow::is_intact`].
    pub(crate) fn is_intact(&self) -> bool {
        self.inner.is_intact()
    }

    /// [`Shadow::map_texels`].
    pub(crate) fn map_texels(&self) -> u64 {
        self.inner.map_texels()
    }
}
