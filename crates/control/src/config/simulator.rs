//! The simulated machine: axes, spindles, magazine and workpiece for the simulator.
use super::scatter::{alignment, real_tools, torque_constant};
use canon::{Flute, Holder, Material, PolygonCutter, Position, Tool, ToolKind, ToolLibrary};
use store::machine::{
    Axis, InputModel, InputSource, Loops, MachineFile, Motor, PositionFrom, Round, Spindle,
    StockMaterial, TapSeat, eccentric,
};
use units::{Angle, AxisKind, Coordinate, Inertia, Lead, Length, Spread, Time};

/// Screw lead that stands in for a linear motor: one radian a millimetre, so that N·m and N agree
/// by 10³.
const DIRECT_LEAD: Lead = Lead::mm_per_rev(std::f64::consts::TAU);

/// A simulated machine of this file at its first workpiece, with these tools in its magazine and
/// nothing in its spindle; the stock is clamped at `zero`.
pub fn simulator(
    machine: &MachineFile,
    tools: &ToolLibrary,
    material: StockMaterial,
    seed: u64,
    zero: &Position,
) -> sim::Config {
    simulator_of_part(machine, tools, material, (seed, 1), zero)
}

/// The same at a workpiece by its number, from 1.
pub fn simulator_of_part(
    machine: &MachineFile,
    tools: &ToolLibrary,
    material: StockMaterial,
    (seed, part): (u64, u32),
    zero: &Position,
) -> sim::Config {
    let axes = machine.axes.iter().enumerate();
    let spindles = machine.spindles.iter().map(|file| spindle(file, machine));
    let stock = machine.setup.stock;
    let shift = machine.simulation.work_shift;
    let clamped = alignment(machine, seed, part);
    let stands = [0, 1, 2].map(|i| zero.linear[i] + shift[i] + clamped[i]);
    let tools = &real_tools(machine, tools, seed, part);
    sim::Config {
        period: machine.control.period,
        substep: machine.simulation.substep,
        command_delay: machine.control.command_delay_periods as usize,
        axes: axes
            .filter_map(|(at, file)| {
                let file = file.as_ref()?;
                Some((at, axis(file, machine, zero.along(file.letter))))
            })
            .collect(),
        spindles: spindles.collect(),
        magazine: tools
            .iter()
            .filter(|t| t.number != 0) // 0 stands for an empty spindle
            .map(|t| tool(t, &machine.simulation.tap_seat, material))
            .collect(),
        tool: 0,
        tool_change_time: machine.tool_change.time,
        carousel: super::changer::carousel(machine, tools, seed),
        stock: Some(sim::Stock {
            top: stands[2] + stock.to[2],
            thickness: Some(stock.to[2] - stock.from[2]),
            sides: Some(sim::Sides {
                x_from: stands[0] + stock.from[0],
                x_to: stands[0] + stock.to[0],
                y_from: stands[1] + stock.from[1],
                y_to: stands[1] + stock.to[1],
            }),
            cutting_n_per_mm2: material.cutting_force_n_per_mm2,
            holes: machine.setup.holes.iter().map(|hole| hole_of(hole, stands)).collect(),
            assume_predrilled: true,
        }),
        scatter: machine.scatter.cutting_force,
        material: machine.scatter.material_strength,
        part,
        seed,
        // a program that is simulated begins on a machine that has been homed
        power_on: sim::PowerOn::Known,
    }
}

/// What the drives of that machine do by themselves.
pub fn left_alone(machine: &MachineFile, config: &sim::Config) -> sim::LeftAlone {
    let drives = &machine.drives;
    sim::LeftAlone {
        config: config.clone(),
        watchdog: drives.watchdog,
        on_silence: drives.on_link_loss,
        on_power_loss: drives.on_power_loss,
        bus: drives.bus.map(|bus| sim::Bus {
            farad: bus.capacitance_f,
            volt: bus.voltage_v,
            trip_volt: bus.trip_v,
        }),
    }
}

/// How the real axis may differ from its file.
fn axis_scatter(file: &Axis, machine: &MachineFile) -> sim::AxisScatter {
    let plant = &machine.scatter;
    let rotary = file.letter.kind() == AxisKind::Rotary;
    let has_screw = matches!(file.drive.motor, Motor::BallScrew { .. });
    let with = |is_there: bool, spread: Spread| if is_there { spread } else { Spread::NONE };
    sim::AxisScatter {
        backlash: plant.backlash,
        stiffness: plant.stiffness,
        friction: plant.friction,
        // a gear's turn is a whole turn of the table after so many of the motor: nothing grows
        lead_error: with(has_screw && !rotary, plant.screw_lead),
        wobble: if rotary {
            with(has_screw, plant.gear_wobble)
        } else {
            with(has_screw, plant.screw_wobble)
        },
        eccentricity: disk(
            &with(has_screw, plant.encoder_eccentricity),
            machine.simulation.graduations.motor,
        ),
        scale_error: with(!rotary, plant.scale_error),
        growth: with(has_screw && !rotary, plant.screw_growth),
    }
}

/// Of a graduation that is off its centre, mm: of what it reads, rev.
fn disk(off: &Spread, diameter: Length) -> Spread {
    Spread { by: eccentric(Length::mm(off.by), diameter).value(), ..*off }
}

/// What is stated to be wrong with it. Everything is zero where the work was touched off.
fn errors(file: &Axis, machine: &MachineFile, zero: Coordinate) -> sim::AxisErrors {
    let by_scale = matches!(file.position_from, PositionFrom::Scale { .. });
    let stated = file.errors;
    sim::AxisErrors {
        lead: stated.scale.filter(|_| !by_scale),
        scale: stated.scale.filter(|_| by_scale),
        wobble: None,
        eccentricity: stated
            .encoder_eccentricity
            .map(|by| (eccentric(by, machine.simulation.graduations.motor), Angle::ZERO)),
        zero,
    }
}

fn axis(file: &Axis, machine: &MachineFile, zero: Coordinate) -> sim::AxisModel {
    let (screw_lead, inertia) = match file.drive.motor {
        Motor::BallScrew { lead, rotating_inertia, .. } => (lead, rotating_inertia),
        Motor::Linear { motor_mass, .. } => {
            // J = m·(lead/2π)², with the lead in metres
            (DIRECT_LEAD, Inertia::kg_m2(motor_mass.value() * 1e-6))
        }
    };
    let metres_per_rad = screw_lead.value() * 1e-3 / std::f64::consts::TAU;
    let friction = &file.friction;
    sim::AxisModel {
        table: file.moving_mass,
        inertia,
        screw_lead: Coordinate::new(screw_lead.value()),
        peak_torque: units::Torque::n_m(file.drive.peak_force().value() * metres_per_rad),
        force_lag: file.drive.force_lag,
        stiffness: file.structure.stiffness,
        damping_ratio: file.structure.damping_ratio,
        backlash: super::compensation::play_behind_drive(file),
        friction: sim::Lugre {
            bristle_stiffness: friction.bristle_stiffness,
            bristle_damping_n_s_per_m: friction.bristle_damping_n_s_per_m,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
            coulomb: friction.coulomb,
            breakaway: friction.static_force,
            stribeck: friction.stribeck_speed,
        },
        weight_share: file.weight_share,
        brake: file.drive.brake,
        encoder: match file.position_from {
            PositionFrom::Motor { counts_per_rev, .. } => {
                sim::AxisEncoder::Motor { counts_per_rev }
            }
            // errors of what a scale would see are compensated: what the drive reports is its
            // motor's
            PositionFrom::Scale { resolution, .. } if super::compensation::is_at_motor(file) => {
                let counts = (screw_lead.value() / resolution.value()).round();
                sim::AxisEncoder::Motor { counts_per_rev: (counts as u32).max(1) }
            }
            PositionFrom::Scale { resolution, motor } => sim::AxisEncoder::Scale {
                resolution,
                motor_counts_per_rev: motor.map(|(counts, _)| counts),
            },
        },
        start: start(file),
        travel: super::homing::along(file),
        scatter: axis_scatter(file, machine),
        errors: errors(file, machine, zero),
        growth: growth(file, machine),
    }
}

/// How its screw grows; the fixed bearing is at the motor's end, which is taken to be that of
/// machine zero.
fn growth(file: &Axis, machine: &MachineFile) -> Option<sim::ScrewGrowth> {
    let is_screw = matches!(file.drive.motor, Motor::BallScrew { .. });
    let stated = machine.simulation.screw_growth?;
    (is_screw && file.letter.kind() == AxisKind::Linear).then(|| sim::ScrewGrowth {
        warm: stated.warm,
        time_constant: stated.time_constant,
        running: stated.running,
        bearing: start(file),
    })
}

/// Where an axis stands when the machine is switched on: at machine zero, or as near as its travel
/// allows.
pub fn start(file: &Axis) -> Coordinate {
    Coordinate::ZERO.max(file.travel.from).min(file.travel.to)
}

fn spindle(file: &Spindle, machine: &MachineFile) -> sim::SpindleModel {
    let graduation = machine.simulation.graduations.spindle;
    let stated = file.errors.encoder_eccentricity;
    sim::SpindleModel {
        inertia: file.inertia,
        peak_torque: file.peak_torque,
        peak_power: file.peak_power,
        torque_lag: file.torque_lag,
        coulomb: file.friction.coulomb,
        viscous_n_m_s_per_rad: file.friction.viscous_n_m_s_per_rad,
        rounding: file.friction.smoothing,
        encoder: sim::SpindleEncoder {
            counts_per_rev: file.encoder_counts_per_rev,
            eccentricity: stated.map_or(Angle::ZERO, |by| eccentric(by, graduation)),
            eccentric_at: Angle::ZERO,
            noise_counts: 0.0,
        },
        start: Angle::ZERO,
        scatter: sim::SpindleScatter {
            friction: machine.scatter.friction,
            eccentricity: if stated.is_some() {
                Spread::NONE
            } else {
                disk(&machine.scatter.encoder_eccentricity, graduation)
            },
        },
    }
}

/// The drive of the first spindle, if it makes its own ramps: as its file says, but for what the
/// simulation knows better.
pub fn plain_drive(machine: &MachineFile) -> Option<sim::PlainDrive> {
    let spindle = machine.spindles.first()?;
    let own = spindle.own_ramps?;
    let real = machine.simulation.spindle_drive;
    Some(sim::PlainDrive {
        delay: own.delay,
        delay_scatter: real.delay_scatter,
        accel: own.acceleration,
        decel: own.deceleration * real.deceleration_share,
        ramp_scatter: real.ramp_scatter_share,
        speed_scatter: real.speed_scatter_share,
        orients: own.orients.then_some((spindle.orient, spindle.orient_acceleration)),
    })
}

/// The drives that measure what they give, their torque constants as the seed has them.
pub fn measured_torques(machine: &MachineFile, seed: u64) -> sim::MeasuredTorques {
    let sensor = |file: store::machine::MeasuredTorque, place: usize| sim::MeasuredTorque {
        resolution_share: file.resolution_share,
        noise_share: file.noise_share,
        delay: file.delay,
        constant_error: torque_constant(&machine.scatter.torque_constant, seed, place),
    };
    let mut measured = sim::MeasuredTorques::default();
    for (index, axis) in machine.axes.iter().enumerate() {
        let file = axis.as_ref().and_then(|axis| axis.drive.measured_torque);
        measured.axes[index] = file.map(|file| sensor(file, index));
    }
    for (index, spindle) in machine.spindles.iter().enumerate().take(bus::SPINDLES) {
        let file = spindle.measured_torque;
        measured.spindles[index] = file.map(|file| sensor(file, bus::AXES + index));
    }
    measured
}

/// Drives that close their position loops, of axes and spindles in their order: those on a network.
/// They take setpoints for the place `ahead` of time on.
pub fn position_drives(
    machine: &MachineFile,
    ahead: Time,
) -> (Vec<Option<sim::PositionDrive>>, Vec<Option<sim::PositionDrive>>) {
    let drive = |loops: &Loops| sim::PositionDrive {
        position_gain_per_s: loops.position_gain_per_s,
        velocity_bandwidth_hz: loops.velocity_bandwidth_hz,
        ahead,
    };
    let axes = machine.axes.iter().flatten();
    let axes = axes.map(|axis| axis.ethercat.is_some().then(|| drive(&axis.loops)));
    let spindles = machine.spindles.iter();
    let spindles = spindles
        .map(|one| (one.ethercat.is_some() && one.closes_position).then(|| drive(&one.loops)));
    (axes.collect(), spindles.collect())
}

fn tool(tool: &Tool, seat: &TapSeat, material: StockMaterial) -> sim::Tool {
    let kind = match &tool.kind {
        ToolKind::Drill { point_angle } | ToolKind::SpotDrill { point_angle } => {
            sim::ToolKind::Drill { diameter: tool.diameter, point_angle: *point_angle }
        }
        ToolKind::Tap(tap) => sim::ToolKind::Tap(sim::Tap {
            diameter: tool.diameter,
            lead: tap.lead,
            chamfer_pitches: tap.chamfer_pitches,
            flute_factor: flute_factor(tap.flute, material),
            thread_length: tap.thread_length,
            flank_play: seat.flank_clearance,
            flank_stiffness: seat.flank_stiffness,
            holder: holder(tap.holder),
            clutch: clutch(tap.holder),
        }),
        ToolKind::Insert(form) => sim::ToolKind::Insert(insert(form)),
        ToolKind::Probe(probe) => sim::ToolKind::Probe(sim::TouchProbe {
            diameter: tool.diameter,
            pretravel: probe.pretravel,
            lobing: probe.lobing,
        }),
        ToolKind::EndMill(_) => sim::ToolKind::Mill { diameter: tool.diameter },
        ToolKind::PolygonCutter(cutter) => {
            let PolygonCutter { radius, inserts, nose_radius } = cutter;
            sim::PolygonCutter::new(*radius, *nose_radius, inserts)
                .map_or(sim::ToolKind::Other, sim::ToolKind::PolygonCutter)
        }
        ToolKind::Hob(_) | ToolKind::Other => sim::ToolKind::Other,
    };
    sim::Tool { number: tool.number, length: tool.worn_length(), kind }
}

/// A hole that the work has when it is clamped.
fn hole_of(hole: &Round, stands: [Length; 3]) -> sim::Hole {
    let bore = sim::Bore { diameter: hole.diameter, tip_depth: hole.height, cone: Length::ZERO };
    let at = [0, 1].map(|i| stands[i] + hole.at[i]);
    sim::Hole { bores: vec![bore], ..sim::Hole::at(at[0], at[1]) }
}

/// What can be touched besides: what stands on the work, wherever that is clamped, and a tool
/// setter.
pub fn touched(
    machine: &MachineFile,
    config: &sim::Config,
) -> (Vec<sim::Boss>, Option<sim::ToolSetter>) {
    let sides = config.stock.as_ref().and_then(|stock| stock.sides);
    let from = machine.setup.stock.from;
    let zero = sides.map(|sides| [sides.x_from - from[0], sides.y_from - from[1]]);
    let bosses = zero.into_iter().flat_map(|zero| {
        machine.setup.bosses.iter().map(move |boss| sim::Boss {
            x: zero[0] + boss.at[0],
            y: zero[1] + boss.at[1],
            diameter: boss.diameter,
            height: boss.height,
        })
    });
    let setter = machine.probe.and_then(|probe| probe.setter).map(|setter| sim::ToolSetter {
        at: setter.at,
        diameter: setter.diameter,
        pretravel: setter.pretravel,
    });
    (bosses.collect(), setter)
}

/// What stands on the inputs.
pub fn inputs(models: &[InputModel]) -> Vec<sim::Input> {
    let source = |source: &InputSource| match source.clone() {
        InputSource::Timed { first, changes } => sim::InputSource::Timed { first, changes },
        InputSource::Follows { output, values, after, within } => {
            sim::InputSource::Follows { output, values, after, within }
        }
    };
    let input = |model: &InputModel| sim::Input {
        number: model.number,
        digital: model.digital,
        source: source(&model.source),
    };
    models.iter().map(input).collect()
}

/// The bar in the first spindle, if that turns the work.
pub fn bar(machine: &MachineFile, config: &sim::Config) -> Option<sim::Bar> {
    let radius = machine.turned_bar()?;
    let stock = config.stock.as_ref()?;
    let (sides, thickness) = (stock.sides?, stock.thickness?);
    Some(sim::Bar {
        axis: [(sides.x_from + sides.x_to) / 2.0, (sides.y_from + sides.y_to) / 2.0],
        radius,
        bore: machine.setup.stock.bore / 2.0,
        face: stock.top,
        rear: stock.top - thickness,
        force: turning_force(machine, stock.cutting_n_per_mm2),
    })
}

/// Kienzle's values of the material that is cut. A pressure that the machine's file states counts
/// for turning by as much as for tapping.
fn turning_force(machine: &MachineFile, tapping: f64) -> sim::Kienzle {
    let own = machine.setup.stock.material;
    let is = |material: &StockMaterial| material.cutting_force_n_per_mm2 == tapping;
    let mut known = Material::ALL.into_iter().map(StockMaterial::usual);
    let chosen = known.find(|known| is(known) && !is(&own)).unwrap_or(own);
    let usual = sim::Kienzle::named(chosen.name());
    let typical = StockMaterial::usual(chosen.material).cutting_force_n_per_mm2;
    let stated = chosen.cutting_force_n_per_mm2 / typical;
    sim::Kienzle { at_1_mm_n_per_mm2: usual.at_1_mm_n_per_mm2 * stated, ..usual }
}

/// An insert; of one whose point the table does not state a sharp one is simulated.
fn insert(form: &canon::Insert) -> sim::Insert {
    let (nose, flat) = match form.point {
        Some(canon::InsertPoint::Nose(radius)) => (radius, Length::ZERO),
        Some(canon::InsertPoint::Flat(width)) => (Length::ZERO, width),
        None => (Length::ZERO, Length::ZERO),
    };
    let edges = match form.edges {
        canon::InsertEdges::Profile => sim::Edges::V,
        canon::InsertEdges::Square => sim::Edges::Square,
        canon::InsertEdges::Corner { approach, length } => {
            let trailing = Angle::deg(180.0) - approach - form.angle;
            sim::Edges::Corner { approach, trailing, length }
        }
    };
    let stands = form.orientation;
    sim::Insert {
        half_angle: if form.angle > Angle::ZERO { form.angle * 0.5 } else { Angle::deg(45.0) },
        nose,
        flat,
        crest_height: form.crest_height,
        edges,
        along: stands.map(canon::InsertOrientation::along),
        is_middle: stands.is_some_and(|stands| stands.is_middle() || stands.is_axial()),
        is_axial: stands.map(canon::InsertOrientation::is_axial),
    }
}

/// Torque of a flute form over the formula's (tap makers' tables).
fn flute_factor(flute: Flute, material: StockMaterial) -> f64 {
    let aluminium = material.material == Material::Aluminium;
    match flute {
        Flute::SpiralFlute if aluminium => 1.05,
        Flute::SpiralFlute => 1.15,
        Flute::SpiralPoint => 0.95,
        Flute::Straight => 1.35,
    }
}

fn holder(holder: Holder) -> sim::Holder {
    match holder {
        Holder::Rigid { stiffness } | Holder::Clutch { stiffness, .. } => {
            sim::Holder { stiffness, travel: None }
        }
        Holder::SoftSynchro { stiffness, travel }
        | Holder::TensionCompression { stiffness, travel } => {
            sim::Holder { stiffness, travel: Some(travel) }
        }
    }
}

/// What lets go of a tap in a clutch holder.
fn clutch(holder: Holder) -> Option<sim::Clutch> {
    match holder {
        Holder::Clutch { spline_length, pawl_backlash, compression, .. } => {
            Some(sim::Clutch { spline_length, pawl_backlash, compression })
        }
        Holder::Rigid { .. } | Holder::SoftSynchro { .. } | Holder::TensionCompression { .. } => {
            None
        }
    }
}

#[cfg(test)]
mod tests;
