//! Buffers, dispatches and copies: everything that is said to the driver.

use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor, BufferUsages,
    CommandEncoder, CommandEncoderDescriptor, ComputePassDescriptor, MapMode,
};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::shaders::Pass;

/// Bytes of the smallest buffer: some are empty, and a pass wants to see one entry at least.
const SMALLEST: u64 = 64;
const PER_BINDING: &str = "max_storage_buffer_binding_size";

/// A part of a buffer that comes back once the work is done.
#[derive(Debug)]
pub(crate) struct Readback {
    buffer: Buffer,
    bytes: u64,
}

impl Gpu {
    /// A buffer that one pass may see as a whole; zeros.
    pub(crate) fn buffer(&self, what: &'static str, bytes: u64) -> Result<Buffer, GpuError> {
        if bytes > self.limits.binding {
            let has = self.limits.binding;
            return Err(GpuError::TooLarge { what, needs: bytes, limit: PER_BINDING, has });
        }
        self.allocate(what, bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST)
    }

    /// A buffer that holds `data`.
    pub(crate) fn filled<T: Pod>(&self, what: &'static str, data: &[T]) -> Result<Buffer, GpuError> {
        let buffer = self.buffer(what, size_of_val(data) as u64)?;
        self.write(&buffer, data);
        Ok(buffer)
    }

    pub(crate) fn write<T: Pod>(&self, buffer: &Buffer, data: &[T]) {
        if !data.is_empty() {
            self.queue.write_buffer(buffer, 0, bytemuck::cast_slice(data));
        }
    }

    pub(crate) fn uniform<T: Pod>(&self, what: &'static str, data: &[T]) -> Result<Buffer, GpuError> {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let buffer = self.allocate(what, size_of_val(data) as u64, usage)?;
        self.write(&buffer, data);
        Ok(buffer)
    }

    fn allocate(&self, what: &'static str, bytes: u64, usage: BufferUsages) -> Result<Buffer, GpuError> {
        if bytes > self.limits.buffer {
            let has = self.limits.buffer;
            return Err(GpuError::TooLarge { what, needs: bytes, limit: "max_buffer_size", has });
        }
        let size = bytes.max(SMALLEST).next_multiple_of(4);
        Ok(self.device.create_buffer(&BufferDescriptor {
            label: Some(what),
            size,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// Begins a list of commands.
    pub(crate) fn commands(&self) -> Commands<'_> {
        let encoder = self.device.create_command_encoder(&CommandEncoderDescriptor::default());
        Commands { gpu: self, encoder }
    }

    /// Waits for a readback of submitted work and unpacks it.
    pub(crate) fn read_back<T: Pod + Zeroable>(&self, readback: &Readback) -> Result<Vec<T>, GpuError> {
        if readback.bytes == 0 {
            return Ok(Vec::new());
        }
        let slice = readback.buffer.slice(..readback.bytes);
        // Whether it was mapped is asked below, after the wait.
        slice.map_async(MapMode::Read, |_| {});
        self.wait()?;
        let view = slice.get_mapped_range().map_err(|error| GpuError::Driver(error.to_string()))?;
        let mut values = vec![T::zeroed(); readback.bytes as usize / size_of::<T>()];
        bytemuck::cast_slice_mut(&mut values).copy_from_slice(&view);
        drop(view);
        readback.buffer.unmap();
        Ok(values)
    }
}

/// Things to do, in order.
pub(crate) struct Commands<'g> {
    pub(crate) gpu: &'g Gpu,
    encoder: CommandEncoder,
}

impl Commands<'_> {
    /// Runs a pass in `groups` workgroups. Binding 0 is `part`, the others follow in order.
    pub(crate) fn run(
        &mut self,
        pass: Pass,
        groups: u64,
        part: &[u32],
        others: &[BindingResource<'_>],
    ) -> Result<(), GpuError> {
        if groups == 0 {
            return Ok(());
        }
        let limit = self.gpu.limits.groups;
        let columns = groups.min(limit);
        let rows = groups.div_ceil(columns);
        if rows > limit {
            let limit_name = "max_compute_workgroups_per_dimension";
            return Err(GpuError::TooLarge { what: pass.name(), needs: rows, limit: limit_name, has: limit });
        }
        let part = self.gpu.uniform("part", part)?;
        let entries: Vec<BindGroupEntry<'_>> = std::iter::once(part.as_entire_binding())
            .chain(others.iter().cloned())
            .zip(0..)
            .map(|(resource, binding)| BindGroupEntry { binding, resource })
            .collect();
        let pipeline = self.gpu.pipeline(pass);
        let group = self.gpu.device.create_bind_group(&BindGroupDescriptor {
            label: Some(pass.name()),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let descriptor = ComputePassDescriptor { label: Some(pass.name()), timestamp_writes: None };
        let mut compute = self.encoder.begin_compute_pass(&descriptor);
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, &group, &[]);
        compute.dispatch_workgroups(columns as u32, rows as u32, 1);
        Ok(())
    }

    /// Asks for a part of a buffer as it is then. Offset and length are multiples of 4.
    pub(crate) fn copy_out(
        &mut self,
        buffer: &Buffer,
        offset: u64,
        bytes: u64,
    ) -> Result<Readback, GpuError> {
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let readback = Readback { buffer: self.gpu.allocate("readback", bytes, usage)?, bytes };
        if bytes > 0 {
            self.encoder.copy_buffer_to_buffer(buffer, offset, &readback.buffer, 0, Some(bytes));
        }
        Ok(readback)
    }

    /// Does everything, and reads a buffer from its start as it is then.
    pub(crate) fn answer<T: Pod + Zeroable>(
        mut self,
        buffer: &Buffer,
        bytes: u64,
    ) -> Result<Vec<T>, GpuError> {
        let (gpu, readback) = (self.gpu, self.copy_out(buffer, 0, bytes)?);
        self.submit();
        gpu.read_back(&readback)
    }

    /// Hands everything to the adapter.
    pub(crate) fn submit(self) {
        self.gpu.queue.submit([self.encoder.finish()]);
    }
}

/// All of a buffer.
pub(crate) fn whole(buffer: &Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

/// Workgroups for one lane an item.
pub(crate) fn groups_of(items: u64, per_group: u32) -> u64 {
    items.div_ceil(u64::from(per_group))
}
