//! From arguments to the plain options that programs are loaded with.
use super::common::{
    Accept, ClutchDwell, Compensation, DecimalPoint, DialectChoice, Estimator, MissingTools,
    ProgramArgs, Switch, Tapping, TappingPreset, ToolUnit, WorkSpeedChoice,
};
use control::job::DEFAULT_MACHINE;
use control::job::options::{self, ProgramOptions};
use store::{cams::WorkSpeed, machine::Preset, tools::TableUnit};

impl ProgramArgs {
    /// For a control or a machine that stays on: nothing is chosen by a program's words.
    pub(crate) fn on_a_machine(&self) -> ProgramOptions {
        ProgramOptions { chooses: false, ..self.options() }
    }

    /// The same without a command line.
    pub(crate) fn options(&self) -> ProgramOptions {
        ProgramOptions {
            machine: self.machine.as_deref().unwrap_or(DEFAULT_MACHINE).into(),
            chooses: self.machine.is_none(),
            without_table: false,
            keeps_table: self.missing_tools == Some(MissingTools::Refuse),
            plant: None,
            tools: self.tools.clone(),
            tool_unit: match self.tool_unit {
                ToolUnit::Mm => TableUnit::Millimetre,
                ToolUnit::Inch => TableUnit::Inch,
            },
            parameters: self.parameters.clone(),
            inputs: self.inputs.clone(),
            missing_tools: match self.missing_tools {
                Some(MissingTools::StandIn) => interp::MissingTools::StandIn,
                Some(MissingTools::Refuse) | None => interp::MissingTools::Refuse,
            },
            pre_drilled: self.pre_drilled,
            stock: self.stock.clone(),
            tapping: self.tapping.map(|asked| match asked {
                Tapping::Synchronised => plan::TapMethod::Synchronised,
                Tapping::Floating => plan::TapMethod::Floating,
            }),
            clutch_dwell: match self.clutch_dwell {
                ClutchDwell::Refuse => plan::DwellCheck::Refuse,
                ClutchDwell::Warn => plan::DwellCheck::Warn,
            },
            dialect: self.dialect.map(Into::into),
            decimal_point: self.decimal_point.map(|asked| match asked {
                DecimalPoint::Increments => options::DecimalPoint::Increments,
                DecimalPoint::Calculator => options::DecimalPoint::Calculator,
            }),
            leaves: interp::Leaves {
                unknown_codes: self.accept.contains(&Accept::UnknownMCodes),
                end: self.accept.contains(&Accept::NoEnd),
                feed: None,
            },
            block_skip: self.block_skip.clone(),
            subprograms: self.subprograms.clone(),
            cams: self.cams.clone(),
            phase_table: self.phase_table.clone(),
            compensation: match self.compensation {
                Compensation::Off => options::Compensation::Off,
                Compensation::Address => options::Compensation::Address,
                Compensation::Shift => options::Compensation::Shift,
                Compensation::Wrong => options::Compensation::Wrong,
                Compensation::Harmonics => options::Compensation::Harmonics,
                Compensation::Learn => options::Compensation::Learn,
            },
            estimator: match self.estimator {
                Estimator::LeastSquares => options::Estimator::LeastSquares,
                Estimator::Flanks => options::Estimator::Flanks,
                Estimator::Maximum => options::Estimator::Maximum,
            },
            work_speed: self.work_speed.map(Into::into),
            without_feed_forward: self.feed_forward == Some(Switch::Off),
            tapping_preset: self.tapping_preset.map(|asked| match asked {
                TappingPreset::Gentle => Preset::Gentle,
                TappingPreset::Standard => Preset::Standard,
                TappingPreset::Fast => Preset::Fast,
                TappingPreset::Max => Preset::Max,
            }),
        }
    }
}

impl From<DialectChoice> for interp::Dialect {
    fn from(choice: DialectChoice) -> Self {
        choice.0
    }
}

impl From<WorkSpeedChoice> for WorkSpeed {
    fn from(choice: WorkSpeedChoice) -> Self {
        match choice {
            WorkSpeedChoice::Constant => Self::Constant,
            WorkSpeedChoice::Even => Self::Even,
        }
    }
}
