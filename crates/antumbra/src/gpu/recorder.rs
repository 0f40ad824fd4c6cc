//! Recorder: a label, a debug group and a pair of timestamps for every pass, or for several passes that are reported as one
//! step.

use super::{CommandsEnd, Gpu, StagedUploads};

/// Position of a pass in a timed step. A step of one pass is [`Span::Only`]; a step of several is timed from the start of the
/// first pass to the end of the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Span {
    /// Only pass of the step.
    Only,
    /// First of several passes.
    First,
    /// Neither first nor last.
    Middle,
    /// Last of several passes.
    Last,
}

impl Span {
    /// Returns the position of item `index` of `count`.
    pub fn of(index: usize, count: usize) -> Self {
        match (index == 0, index + 1 == count) {
            (true, true) => Self::Only,
            (true, false) => Self::First,
            (false, false) => Self::Middle,
            (false, true) => Self::Last,
        }
    }
}

/// GPU time of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// Label of the step; times of equal labels are added.
    pub label: &'static str,
    /// Time, milliseconds.
    pub ms: f64,
}

/// Collects the step times of one frame.
///
/// Usage: pass it to [`Recorder::new`]; after the last pass call [`resolve`](Self::resolve) on the same encoder; submit; map
/// [`readback`](Self::readback); pass its bytes to [`read`](Self::read).
#[derive(Debug)]
pub struct PassTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readback: wgpu::Buffer,
    labels: Vec<&'static str>,
    period_ns: f32,
}

/// WebGPU's limit for a query set. It limits the steps of a frame, which need two queries each.
const MAX_QUERIES: u32 = 4096;

impl PassTimer {
    /// Creates a timer, or returns `None` if the device lacks `TIMESTAMP_QUERY`.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.has(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let bytes = u64::from(MAX_QUERIES) * 8;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("antumbra timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: MAX_QUERIES,
            }),
            resolved: buffer(
                "antumbra timestamps resolved",
                wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            ),
            readback: buffer(
                "antumbra timestamps readback",
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            ),
            labels: Vec::new(),
            period_ns: gpu.queue.get_timestamp_period(),
        })
    }

    /// Discards the last frame's labels.
    pub fn reset(&mut self) {
        self.labels.clear();
    }

    /// Copies the frame's timestamps to [`readback`](Self::readback). Call once, after the last pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let count = 2 * self.labels.len() as u32;
        if count > 0 {
            encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readback, 0, u64::from(count) * 8);
        }
    }

    /// Number of bytes of [`readback`](Self::readback) that the frame filled.
    pub fn readback_bytes(&self) -> u64 {
        self.labels.len() as u64 * 16
    }

    /// Buffer to map for reading after the submission.
    pub fn readback(&self) -> &wgpu::Buffer {
        &self.readback
    }

    /// Returns the times from the mapped bytes, by label in order of first use.
    pub fn read(&self, bytes: &[u8]) -> Vec<PassTime> {
        let mut times: Vec<PassTime> = Vec::new();
        for (label, pair) in self.labels.iter().zip(bytes.chunks_exact(16)) {
            let tick = |i: usize| u64::from_le_bytes(pair[8 * i..8 * i + 8].try_into().unwrap_or_default());
            let ms = tick(1).saturating_sub(tick(0)) as f64 * f64::from(self.period_ns) * 1e-6;
            match times.iter_mut().find(|time| time.label == *label) {
                Some(time) => time.ms += ms,
                None => times.push(PassTime { label, ms }),
            }
        }
        times
    }

    /// Returns the query indices for the begin and end of a pass; `None` if the pass writes neither.
    fn writes(&mut self, label: &'static str, span: Span) -> Option<(&wgpu::QuerySet, Option<u32>, Option<u32>)> {
        if matches!(span, Span::Only | Span::First) && 2 * self.labels.len() as u32 + 2 <= MAX_QUERIES {
            self.labels.push(label);
        }
        if self.labels.last() != Some(&label) {
            return None;
        }
        let begin = 2 * (self.labels.len() as u32 - 1);
        match span {
            Span::Only => Some((&self.queries, Some(begin), Some(begin + 1))),
            Span::First => Some((&self.queries, Some(begin), None)),
            Span::Middle => None,
            Span::Last => Some((&self.queries, None, Some(begin + 1))),
        }
    }
}

/// Recorded pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// Label of the step that the pass belongs to.
    pub label: &'static str,
    /// Whether the pass draws casters.
    pub draws_casters: bool,
}

/// Records passes of one or several lights into the host's encoder.
#[derive(Debug)]
pub struct Recorder<'a> {
    encoder: &'a mut wgpu::CommandEncoder,
    timer: Option<&'a mut PassTimer>,
    passes: Vec<Pass>,
    /// Whether consecutive compute steps share one wgpu compute pass, which costs less CPU time. Timestamps are per pass, so
    /// with a timer each step has a pass of its own.
    joins_steps: bool,
    /// Open compute pass for the next compute step, if any.
    open: Option<wgpu::ComputePass<'static>>,
}

impl<'a> Recorder<'a> {
    /// Creates a recorder; without a timer nothing is timed.
    pub fn new(encoder: &'a mut wgpu::CommandEncoder, mut timer: Option<&'a mut PassTimer>) -> Self {
        if let Some(timer) = &mut timer {
            timer.reset();
        }
        Self { encoder, timer, passes: Vec::new(), joins_steps: false, open: None }
    }

    /// Passes recorded so far, in order. Cached maps and masks that were not drawn again have none.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// Records a light's steps, sharing compute passes unless they are timed. No pass is open afterwards, because the encoder
    /// returns to the host.
    pub(crate) fn joining_compute_passes(&mut self, record: impl FnOnce(&mut Self)) {
        self.joins_steps = self.timer.is_none();
        record(self);
        (self.joins_steps, self.open) = (false, None);
    }

    /// Returns the encoder, outside any pass.
    pub(crate) fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.open = None;
        self.encoder
    }

    /// Records a frame's uploads; `then` is notified when the commands are done or dropped.
    pub(crate) fn upload(&mut self, uploads: StagedUploads, then: CommandsEnd) {
        uploads.record(self.encoder(), then);
    }

    /// Copies the first bytes of a buffer to a mappable one, which is mapped once the commands are submitted.
    pub(crate) fn read_back(
        &mut self,
        from: &wgpu::Buffer,
        to: &wgpu::Buffer,
        bytes: u64,
        then: impl FnOnce(Result<(), wgpu::BufferAsyncError>) + wgpu::WasmNotSend + 'static,
    ) {
        let encoder = self.encoder();
        encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
        encoder.map_buffer_on_submit(to, wgpu::MapMode::Read, .., then);
    }

    /// Fills a buffer with zeros.
    pub(crate) fn clear_buffer(&mut self, buffer: &wgpu::Buffer) {
        self.encoder().clear_buffer(buffer, 0, None);
    }

    /// Records a compute pass.
    pub(crate) fn compute(&mut self, label: &'static str, span: Span, record: impl FnOnce(&mut wgpu::ComputePass<'_>)) {
        self.passes.push(Pass { label, draws_casters: false });
        if self.joins_steps {
            let Self { encoder, open, .. } = self;
            let descriptor = wgpu::ComputePassDescriptor { label: Some("antumbra"), timestamp_writes: None };
            let pass = open.get_or_insert_with(|| encoder.begin_compute_pass(&descriptor).forget_lifetime());
            // By default wgpu passes labels to the driver only in debug builds.
            if cfg!(debug_assertions) {
                pass.push_debug_group(label);
            }
            record(pass);
            if cfg!(debug_assertions) {
                pass.pop_debug_group();
            }
            return;
        }
        let writes = self.timer.as_deref_mut().and_then(|timer| timer.writes(label, span));
        let timestamp_writes = writes.map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        });
        let mut pass =
            self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes });
        record(&mut pass);
    }

    /// Records a compute pass that shares wgpu's pass with no other step.
    pub(crate) fn compute_apart(
        &mut self,
        label: &'static str,
        span: Span,
        record: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        self.open = None;
        self.compute(label, span, record);
        self.open = None;
    }

    /// Records commands outside any pass as part of a timed step; empty passes write the timestamps.
    pub(crate) fn commands(&mut self, label: &'static str, span: Span, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        if matches!(span, Span::Only | Span::First) {
            self.compute(label, Span::First, |_| {});
        }
        record(self.encoder());
        if matches!(span, Span::Only | Span::Last) {
            self.compute(label, Span::Last, |_| {});
        }
    }

    /// Records a pass that draws only the depth of casters, cleared to `clear_depth`.
    pub(crate) fn depth_pass(
        &mut self,
        label: &'static str,
        span: Span,
        target: &wgpu::TextureView,
        clear_depth: f32,
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let cleared = wgpu::Operations { load: wgpu::LoadOp::Clear(clear_depth), store: wgpu::StoreOp::Store };
        self.render_pass(label, span, &[], target, Some(cleared), record);
    }

    /// Records a pass that draws over the present content of `targets`.
    pub(crate) fn color_pass<'v>(
        &mut self,
        label: &'static str,
        span: Span,
        targets: &[&'v wgpu::TextureView],
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        self.passes.push(Pass { label, draws_casters: false });
        let color = |view: &&'v wgpu::TextureView| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })
        };
        let colors: Vec<_> = targets.iter().map(color).collect();
        self.begin_render_pass(label, span, &colors, None, record);
    }

    /// Records a pass that fills a texture with zeros.
    pub(crate) fn clear(&mut self, label: &'static str, view: &wgpu::TextureView) {
        self.passes.push(Pass { label, draws_casters: false });
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
        let color = wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops };
        self.begin_render_pass(label, Span::Only, &[Some(color)], None, |_| {});
    }

    /// Records a pass that draws casters to `colors`. Without `depth_ops` the depth attachment is read-only.
    pub(crate) fn render_pass(
        &mut self,
        label: &'static str,
        span: Span,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: &wgpu::TextureView,
        depth_ops: Option<wgpu::Operations<f32>>,
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        self.passes.push(Pass { label, draws_casters: true });
        let depth = wgpu::RenderPassDepthStencilAttachment { view: depth, depth_ops, stencil_ops: None };
        self.begin_render_pass(label, span, colors, Some(depth), record);
    }

    fn begin_render_pass(
        &mut self,
        label: &'static str,
        span: Span,
        color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let writes = self.timer.as_deref_mut().and_then(|timer| timer.writes(label, span));
        let timestamp_writes = writes.map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        });
        self.open = None;
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments,
            depth_stencil_attachment,
            timestamp_writes,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        record(&mut pass);
    }
}
