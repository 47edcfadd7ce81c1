//! An open adapter: its limits, its compiled passes, and what it says when something goes wrong.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use l4d_splat::raster::RasterError;
use wgpu::{
    ComputePipeline, Device, DeviceDescriptor, ErrorFilter, Limits, PipelineCompilationOptions, PollType,
    Queue,
};

use crate::adapter::{AdapterChoice, AdapterReport, choose};
use crate::error::{Failure, GpuError};
use crate::shaders::Pass;

/// A graphics adapter that draws splats.
///
/// May be shared among threads; what is asked of it is done one after the other.
#[derive(Debug)]
pub struct Gpu {
    report: AdapterReport,
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    /// In the order of [`Pass::ALL`]; compiled when first used.
    pipelines: [OnceLock<ComputePipeline>; Pass::ALL.len()],
    pub(crate) limits: BufferLimits,
    driver_errors: Arc<DriverErrors>,
}

/// How large things may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BufferLimits {
    /// Of what one pass sees of a buffer, bytes.
    pub(crate) binding: u64,
    /// Of a buffer, bytes.
    pub(crate) buffer: u64,
    /// Workgroups along one dimension.
    pub(crate) groups: u64,
}

/// Errors of the driver outside of any scope.
#[derive(Debug, Default)]
struct DriverErrors {
    lost: OnceLock<String>,
    uncaptured: Mutex<Option<GpuError>>,
}

impl Gpu {
    /// Opens an adapter. Its passes are compiled when they are first needed.
    ///
    /// # Errors
    /// No such adapter (with the list of those found), and limits below what WebGPU promises.
    pub fn open(choice: &AdapterChoice) -> Result<Self, GpuError> {
        let adapter = choose(choice)?;
        let report = AdapterReport::of(&adapter);
        let available = adapter.limits();
        // What WebGPU promises everywhere is enough, apart from size: take all that there is.
        let limits = Limits {
            max_storage_buffer_binding_size: available.max_storage_buffer_binding_size,
            max_buffer_size: available.max_buffer_size,
            ..Limits::default()
        };
        let mut unfit = None;
        limits.check_limits_with_fail_fn(&available, true, |limit, needs, has| {
            unfit = Some((limit, needs, has));
        });
        if let Some((limit, needs, has)) = unfit {
            return Err(GpuError::Unfit { adapter: report.name, limit, needs, has });
        }
        let descriptor = DeviceDescriptor {
            label: Some("l4d"),
            required_limits: limits.clone(),
            ..DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|source| GpuError::Closed { adapter: report.name.clone(), source })?;
        let driver_errors = Arc::new(DriverErrors::default());
        let reported = Arc::clone(&driver_errors);
        device.on_uncaptured_error(Arc::new(move |error| reported.note(driver_error(error))));
        let reported = Arc::clone(&driver_errors);
        device.set_device_lost_callback(move |reason, message| {
            let _ = reported.lost.set(format!("{reason:?}: {message}"));
        });
        let limits = BufferLimits {
            binding: limits.max_storage_buffer_binding_size,
            buffer: limits.max_buffer_size,
            groups: limits.max_compute_workgroups_per_dimension.into(),
        };
        Ok(Self { report, device, queue, pipelines: [const { OnceLock::new() }; _], limits, driver_errors })
    }

    /// The adapter, for manifests and people.
    pub fn adapter(&self) -> &AdapterReport {
        &self.report
    }

    /// As if the adapter let no pass see more than `bytes` of a buffer, where it would.
    #[must_use]
    pub fn with_binding_limit(mut self, bytes: u64) -> Self {
        self.limits.binding = self.limits.binding.min(bytes);
        self
    }

    pub(crate) fn pipeline(&self, pass: Pass) -> &ComputePipeline {
        self.pipelines[pass as usize].get_or_init(|| {
            let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(pass.name()),
                source: wgpu::ShaderSource::Wgsl(pass.source().into()),
            });
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(pass.name()),
                layout: None,
                module: &module,
                entry_point: None,
                compilation_options: PipelineCompilationOptions {
                    // Every pass writes what it reads.
                    zero_initialize_workgroup_memory: false,
                    ..PipelineCompilationOptions::default()
                },
                cache: None,
            })
        })
    }

    /// Does some work, listening to the driver. What it says weighs more than how the work went on after it.
    pub(crate) fn with_error_scopes<T>(
        &self,
        work: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<T, RasterError> {
        self.check().map_err(|error| self.raster_error(error))?;
        let filters = [ErrorFilter::Validation, ErrorFilter::Internal, ErrorFilter::OutOfMemory];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let outcome = work();
        let mut reported = None;
        for scope in scopes.into_iter().rev() {
            let error = pollster::block_on(scope.pop());
            reported = reported.or(error.map(driver_error));
        }
        let problem = self.check().err().or(reported);
        match (problem, outcome) {
            (Some(error), _) | (None, Err(Failure::Gpu(error))) => Err(self.raster_error(error)),
            (None, Err(Failure::Raster(error))) => Err(error),
            (None, Ok(answer)) => Ok(answer),
        }
    }

    /// Waits until the adapter has done all it was told.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        // The library panics here, and only here, if the driver loses the adapter during the wait.
        let waited = catch_unwind(AssertUnwindSafe(|| self.device.poll(PollType::wait_indefinitely())));
        self.check()?;
        match waited {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(GpuError::Driver(error.to_string())),
            Err(_) => Err(GpuError::Lost { reason: "it failed while it was waited for".into() }),
        }
    }

    fn check(&self) -> Result<(), GpuError> {
        if let Some(reason) = self.driver_errors.lost.get() {
            return Err(GpuError::Lost { reason: reason.clone() });
        }
        let mut uncaptured = self.driver_errors.uncaptured.lock().unwrap_or_else(PoisonError::into_inner);
        uncaptured.take().map_or(Ok(()), Err)
    }

    fn raster_error(&self, error: GpuError) -> RasterError {
        RasterError::Backend { rasterizer: self.title(), source: Box::new(error) }
    }

    pub(crate) fn title(&self) -> String {
        format!("wgpu on {}", self.report)
    }
}

impl DriverErrors {
    fn note(&self, error: GpuError) {
        let mut uncaptured = self.uncaptured.lock().unwrap_or_else(PoisonError::into_inner);
        uncaptured.get_or_insert(error);
    }
}

fn driver_error(error: wgpu::Error) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory,
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            GpuError::Driver(description)
        }
    }
}

#[cfg(test)]
mod tests {
    use l4d_splat::raster::{RasterSettings, Rasterizer};
    use l4d_splat::splats::{SplatParts, Splats};
    use l4d_splat::view::View;

    use super::*;
    use crate::commands::whole;

    fn open() -> Gpu {
        Gpu::open(&AdapterChoice::Best).unwrap_or_else(|error| panic!("{error}"))
    }

    fn one_gaussian() -> Splats {
        Splats::new(SplatParts {
            means: vec![[0.0, 0.0, 3.0]],
            scales: vec![[0.3; 3]],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]],
            opacities: vec![0.5],
            sh: vec![[0.2; 3]],
            ..SplatParts::default()
        })
        .unwrap()
    }

    fn small_view() -> View {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        View::new([20, 20], [20.0, 20.0], [10.0, 10.0], pose).unwrap()
    }

    fn source_of(error: &RasterError) -> String {
        let RasterError::Backend { source, .. } = error else { panic!("{error}") };
        source.to_string()
    }

    #[test]
    fn a_lost_adapter_is_an_error_before_and_during_work() {
        let gpu = open();
        let splats = one_gaussian();
        let view = small_view();
        let settings = RasterSettings::default();
        let prepared = gpu.prepare(&splats, &view, &settings).unwrap();
        assert!(prepared.draw().is_ok());
        gpu.device.destroy();
        let during = prepared.draw().unwrap_err();
        assert!(source_of(&during).contains("lost"), "{during:?}");
        let after = gpu.prepare(&splats, &view, &settings).err().unwrap();
        assert!(source_of(&after).contains("lost"), "{after:?}");
        assert!(matches!(gpu.wait(), Err(GpuError::Lost { .. })));
    }

    #[test]
    fn memory_that_is_used_up_has_an_error_of_its_own() {
        let error = driver_error(wgpu::Error::OutOfMemory { source: "vkAllocateMemory".into() });
        assert!(matches!(error, GpuError::OutOfMemory));
        // Reported outside of any scope: the next call returns it.
        let gpu = open();
        gpu.driver_errors.note(error);
        let error = gpu.prepare(&one_gaussian(), &small_view(), &RasterSettings::default()).err().unwrap();
        assert!(source_of(&error).contains("out of memory: close what else uses it"), "{error:?}");
    }

    #[test]
    fn what_the_driver_rejects_is_an_error_and_the_adapter_goes_on() {
        let gpu = open();
        // The pass has more bindings than it is given.
        let wrong = gpu.with_error_scopes(|| {
            let mut commands = gpu.commands();
            let buffer = gpu.buffer("alone", 16)?;
            commands.run(Pass::Count, 1, &[0_u32; 4], &[whole(&buffer)])?;
            commands.submit();
            Ok(())
        });
        assert!(source_of(&wrong.unwrap_err()).contains("the graphics driver reports"));
        // The same outside of any scope: the next call returns it, once.
        let mut commands = gpu.commands();
        let buffer = gpu.buffer("alone", 16).unwrap();
        commands.run(Pass::Count, 1, &[0_u32; 4], &[whole(&buffer)]).unwrap();
        drop(commands);
        assert!(gpu.with_error_scopes(|| Ok(())).is_err());
        assert!(gpu.with_error_scopes(|| Ok(())).is_ok());
    }

    #[test]
    fn buffers_beyond_a_limit_are_refused_with_its_name() {
        let gpu = open().with_binding_limit(1000);
        let error = gpu.buffer("things", 1001).unwrap_err().to_string();
        assert!(error.contains("things would take 1001") && error.contains("is 1000"), "{error}");
        assert!(error.contains("max_storage_buffer_binding_size"), "{error}");
        assert!(gpu.buffer("things", 1000).is_ok());
        let mut gpu = gpu;
        gpu.limits = BufferLimits { binding: u64::MAX, buffer: 1000, ..gpu.limits };
        let error = gpu.buffer("things", 1001).unwrap_err().to_string();
        assert!(error.contains("max_buffer_size"), "{error}");
    }
}
