//! The interpreter of channel programs: colours, coefficients and heights that vary over a surface.
//!
//! A program is a run of records. Its registers are (u, v, w), (x, y, z) and a number; every program starts with
//! those of the surface point. Most records change a register and go on at the next one. A program ends in a
//! colour, or goes on in one of the programs of its parts (checkers): then nothing is to be remembered, and nesting
//! costs nothing but time.
//!
//! Where several colours are needed they are summed up with weights. A blend sets the second colour aside with its
//! weight and goes on with the first; a filter sets itself aside and comes back for one neighbour after the other,
//! each with its own shift of the surface point; a call sets the sum aside and takes the colour that its program
//! finds as coordinates. What is set aside waits on a stack of `MAX_PENDING` entries. The compiler of scenes knows
//! how deep each program gets and refuses those that would not fit, and those that take too many steps
//! (`scene::Effort`); a record refers only to the next one or to programs that are complete before its own, so
//! that every program ends.

use wgsl_rs::wgsl;

#[wgsl]
pub mod kernel {
    use crate::coordinates::kernel::*;
    use crate::noise::kernel::*;
    use crate::records::kernel::*;
    use crate::texture::kernel::*;
    use crate::volume::kernel::*;
    use crate::warp::kernel::*;
    use wgsl_rs::std::*;

    /// Entries of the stack of what is set aside.
    pub const MAX_PENDING: u32 = 8;

    /// What an instruction reads and writes.
    #[derive(Copy, Clone, Debug, Wgsl)]
    pub struct ChannelRegisters {
        /// Texture coordinates; w is 0 on the surface.
        pub uvw: Vec3f,
        /// Position in metres.
        pub xyz: Vec3f,
        /// The number that volume functions compute.
        pub number: f32,
        /// The next instruction.
        pub next: u32,
    }

    /// Value of a channel at a surface point; `missing` if there is no such channel.
    pub fn channel_value<S: SceneAccess + Copy>(
        scene: S,
        index: u32,
        at: TexturePoint,
        missing: Vec4f,
    ) -> Vec4f {
        if index == NONE {
            return missing;
        }
        let channel = S::channel(scene, index);
        if has::<S>(scene, FEATURE_IMAGES) && channel.operation == CHANNEL_IMAGE {
            return image_color::<S>(scene, channel, at.uv);
        }
        if has::<S>(scene, FEATURE_PROGRAMS) && channel.operation != CHANNEL_CONSTANT {
            return run_channel::<S>(scene, index, at);
        }
        channel.value
    }

    /// The registers at the start of a program for the surface point moved by `shift`, in u, v, w and x, y, z alike.
    pub fn start_registers(at: TexturePoint, shift: Vec3f, start: u32) -> ChannelRegisters {
        ChannelRegisters {
            uvw: vec3f(at.uv.x, at.uv.y, 0.0) + shift,
            xyz: at.local + shift,
            number: 0.0,
            next: start,
        }
    }

    /// One of the instructions that change coordinates; the others have no effect here.
    pub fn change_coordinates<S: SceneAccess + Copy>(
        scene: S,
        record: ChannelRecord,
        world: Vec3f,
        before: ChannelRegisters,
    ) -> ChannelRegisters {
        let mut after = before;
        let v = record.value;
        let uvw = before.uvw;
        if record.operation == CHANNEL_MOVE_UV {
            after.uvw = vec3f(uvw.x + v.x, uvw.y + v.y, uvw.z);
        }
        if record.operation == CHANNEL_LINEAR_UV {
            after.uvw = vec3f(v.x * uvw.x + v.y * uvw.y, v.z * uvw.x + v.w * uvw.y, uvw.z);
        }
        if record.operation == CHANNEL_AFFINE_XYZ {
            let row1 = S::channel(scene, before.next);
            let row2 = S::channel(scene, before.next + 1u32);
            let rows = Affine { row0: v, row1: row1.value, row2: row2.value };
            let mut p = before.xyz;
            if record.first == 1u32 {
                p = world;
            }
            after.xyz = transform_point(rows, p);
            after.next = before.next + 2u32;
        }
        after
    }

    /// One of the instructions that compute the number, the noise of coordinates included.
    pub fn compute_number<S: SceneAccess + Copy>(
        scene: S,
        record: ChannelRecord,
        before: ChannelRegisters,
    ) -> ChannelRegisters {
        let mut after = before;
        let op = record.operation;
        let v = record.value;
        let p = before.xyz;
        if op == CHANNEL_TURBULENCE || op == CHANNEL_NOISE {
            let ratios = S::channel(scene, before.next);
            after.next = before.next + 1u32;
            let mut q = p * v.x;
            let mut kind = record.mode;
            if op == CHANNEL_TURBULENCE {
                kind = NOISE_VECTOR;
                q = p;
                if record.mode == 1u32 {
                    q = before.uvw;
                }
            }
            let noise = octaves_of_noise::<S>(
                scene,
                record.first,
                q,
                record.size,
                ratios.value.x,
                ratios.value.y,
                kind,
            );
            let moved = q + vec3f(v.x, v.y, v.z) * noise;
            if op == CHANNEL_NOISE {
                after.number = noise.x;
            } else if record.mode == 1u32 {
                after.uvw = moved;
            } else {
                after.xyz = moved;
            }
        }
        if op == CHANNEL_GRADIENT {
            after.number = dot(p, vec3f(v.x, v.y, v.z));
        }
        if op == CHANNEL_WOOD {
            after.number = sqrt(p.x * p.x + p.y * p.y);
        }
        if op == CHANNEL_LEOPARD {
            after.number = leopard(p);
        }
        if op == CHANNEL_FRACTAL {
            let z = vec2f(fractal_coordinate(p.x), fractal_coordinate(p.y));
            let mut c = z;
            if record.first == 1u32 {
                c = vec2f(v.x, v.y);
            }
            after.number = fractal(z, c, record.size);
        }
        if op == CHANNEL_WAVES {
            after.number = cos(TWO_PI * v.x * before.uvw.x) * cos(TWO_PI * v.y * before.uvw.y);
        }
        if op == CHANNEL_LINEAR {
            after.number = before.number * v.x + v.y;
        }
        if op == CHANNEL_WAVE_FORM {
            after.number = wave_form(record.first, before.number);
        }
        after
    }

    /// The item of a ramp of `count` items from record `first` on that is the first behind `t`; `count` if none is.
    pub fn first_item_behind<S: SceneAccess + Copy>(scene: S, first: u32, count: u32, t: f32) -> u32 {
        let mut item: u32 = 0;
        let mut searching = true;
        while searching && item < count {
            let record = S::channel(scene, first + item);
            searching = record.value.x <= t;
            if searching {
                item += 1;
            }
        }
        item
    }

    /// Direction of a filter's neighbour in units of its steps, and as w the weight.
    pub fn filter_neighbour(count: u32, number: u32) -> Vec4f {
        if count == 27u32 {
            let x = f32(number % 3u32) - 1.0;
            let y = f32((number / 3u32) % 3u32) - 1.0;
            let z = f32(number / 9u32) - 1.0;
            return vec4f(x, y, z, 1.0 / 27.0);
        }
        if number == 0u32 {
            return vec4f(0.0, 0.0, 0.0, 0.5);
        }
        let axis = (number - 1u32) / 2u32;
        let side = f32(number & 1u32) * 2.0 - 1.0;
        vec4f(
            select(0.0, side, axis == 0u32),
            select(0.0, side, axis == 1u32),
            select(0.0, side, axis == 2u32),
            -1.0 / 12.0,
        )
    }

    /// Runs the program of a channel from record `start` on.
    pub fn run_channel<S: SceneAccess + Copy>(scene: S, start: u32, at: TexturePoint) -> Vec4f {
        let zero = vec4f(0.0, 0.0, 0.0, 0.0);
        // What is set aside: x, y, z of the shift with the weight of the colour; the sum of a call; the weight of
        // alpha; the record that set it aside, or the item of a blend; how many neighbours of a filter are done.
        let mut shifts: [Vec4f; 8] = [zero, zero, zero, zero, zero, zero, zero, zero];
        let mut sums: [Vec4f; 8] = [zero, zero, zero, zero, zero, zero, zero, zero];
        let mut alphas: [f32; 8] = [0.0f32; 8];
        let mut origins: [u32; 8] = [0u32; 8];
        let mut counts: [u32; 8] = [0u32; 8];
        let mut pending: u32 = 0;

        let mut sum = zero;
        let mut shift = vec3f(0.0, 0.0, 0.0);
        let mut weight: f32 = 1.0;
        let mut alpha_weight: f32 = 1.0;
        let mut registers = start_registers(at, shift, start);
        let mut running = true;
        while running {
            let record_index = registers.next;
            let record = S::channel(scene, record_index);
            let op = record.operation;
            registers.next = record_index + 1u32;
            let mut ended = op <= CHANNEL_IMAGE || op == CHANNEL_GREY;
            if ended {
                let mut color = record.value;
                if op == CHANNEL_IMAGE {
                    color = image_color::<S>(scene, record, vec2f(registers.uvw.x, registers.uvw.y));
                }
                if op == CHANNEL_GREY {
                    color = vec4f(registers.number, registers.number, registers.number, 1.0);
                }
                sum += color * vec4f(weight, weight, weight, alpha_weight);
            } else if op == CHANNEL_CHECKER || op == CHANNEL_VOLUME_CHECKER {
                let mut odd = in_odd_field(vec2f(registers.uvw.x, registers.uvw.y));
                if op == CHANNEL_VOLUME_CHECKER {
                    odd = in_odd_cube(registers.xyz);
                }
                registers = start_registers(at, shift, select(record.size, record.first, odd));
            } else if op == CHANNEL_CALL {
                shifts[pending as usize] = vec4f(shift.x, shift.y, shift.z, weight);
                sums[pending as usize] = sum;
                alphas[pending as usize] = alpha_weight;
                origins[pending as usize] = record_index;
                pending += 1;
                sum = zero;
                weight = 1.0;
                registers = start_registers(at, shift, record.first);
            } else if op == CHANNEL_BLEND {
                let t = registers.xyz.x;
                let items = record_index + 1u32;
                let behind = first_item_behind::<S>(scene, items, record.size, t);
                let upper = S::channel(scene, items + min(behind, record.size - 1u32));
                let mut lower = upper;
                if behind > 0u32 && behind < record.size {
                    lower = S::channel(scene, items + behind - 1u32);
                    let share = (t - lower.value.x) / (upper.value.x - lower.value.x);
                    shifts[pending as usize] = vec4f(shift.x, shift.y, shift.z, weight * share);
                    alphas[pending as usize] = alpha_weight * share;
                    origins[pending as usize] = items + behind;
                    pending += 1;
                    weight *= 1.0 - share;
                    alpha_weight *= 1.0 - share;
                }
                registers = start_registers(at, shift, lower.first);
            } else if op == CHANNEL_FILTER {
                // Alpha is 1, that of the neighbours does not count.
                sum.w += alpha_weight;
                shifts[pending as usize] = vec4f(shift.x, shift.y, shift.z, weight);
                alphas[pending as usize] = 0.0;
                origins[pending as usize] = record_index;
                counts[pending as usize] = 0u32;
                pending += 1;
                ended = true;
            } else if op < CHANNEL_TURBULENCE {
                registers = change_coordinates::<S>(scene, record, at.world, registers);
            } else {
                registers = compute_number::<S>(scene, record, registers);
            }

            if ended && pending == 0u32 {
                running = false;
            } else if ended {
                // Back to what was set aside last.
                let top = pending - 1u32;
                let origin_index = origins[top as usize];
                let origin = S::channel(scene, origin_index);
                let aside = shifts[top as usize];
                shift = vec3f(aside.x, aside.y, aside.z);
                weight = aside.w;
                alpha_weight = alphas[top as usize];
                if origin.operation == CHANNEL_CALL {
                    let found = vec3f(sum.x, sum.y, sum.z);
                    registers.uvw = found;
                    registers.xyz = found;
                    registers.next = origin_index + 1u32;
                    sum = sums[top as usize];
                    pending = top;
                } else {
                    let number = counts[top as usize];
                    if origin.operation == CHANNEL_FILTER && number + 1u32 < origin.size {
                        counts[top as usize] = number + 1u32;
                    } else {
                        pending = top;
                    }
                    if origin.operation == CHANNEL_FILTER {
                        let neighbour = filter_neighbour(origin.size, number);
                        let step = vec3f(origin.value.x, origin.value.y, origin.value.z);
                        shift += step * vec3f(neighbour.x, neighbour.y, neighbour.z);
                        weight *= neighbour.w;
                    }
                    registers = start_registers(at, shift, origin.first);
                }
            }
        }
        sum
    }
}
