//! A feature of the workpiece with its verdict and measures.
use serde::Serialize;
use units::Length;
use verify::{Feature, FeatureKind, Verdict};

/// What was cut, as it was judged. Measures that a kind has not are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct FeatureBody {
    /// Number of its operation.
    pub op: u32,
    /// The program's line.
    pub line: u32,
    /// `hole`, `thread`, `polygon`, `cam`, `turned thread`, `gear`.
    pub kind: &'static str,
    /// The tool that cut it.
    pub tool: Option<u32>,
    /// When it was begun, machine time.
    pub time_s: f64,
    /// How long it took.
    pub duration_s: f64,
    /// `good`, `failed`, `not_judged`.
    pub verdict: &'static str,
    /// Why it is not good.
    pub reason: Option<String>,
    /// X and Y of the machine, mm; what is turned about the work's own axis has no place.
    pub position: Option<[f64; 2]>,
    /// Depth of a hole; length of full thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub depth_mm: Option<f64>,
    /// Depth less the programmed one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub depth_error_um: Option<f64>,
    /// Distance from the programmed place.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub position_error_um: Option<f64>,
    /// Diameter of a hole.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub diameter_mm: Option<f64>,
    /// Size of a thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub size: Option<String>,
    /// Lead of a thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub lead_mm_per_rev: Option<f64>,
    /// Largest sync error in the material.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub sync_error_max_um: Option<f64>,
    /// Depth of the tip at which that was.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub sync_error_depth_mm: Option<f64>,
    /// Root of the mean square of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub sync_error_rms_um: Option<f64>,
    /// Finest class whose gauges agree, `none` if not even the coarsest; `not gauged`: there is no
    /// full thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub class: Option<&'static str>,
    /// Class asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub class_asked: Option<&'static str>,
    /// Distance of the gauge that limits from its limit; negative is out of tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub margin_um: Option<f64>,
    /// Which gauge that is.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub limiting_gauge: Option<&'static str>,
    /// Pitch diameter of a thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub pitch_diameter_mm: Option<f64>,
    /// Fastest spindle speed in the material.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub spin_max_rpm: Option<f64>,
    /// Largest torque of the cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub torque_max_n_m: Option<f64>,
    /// The tool was taken out after a stop in the thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub is_recovered: Option<bool>,
}

/// What was not measured is absent, never a number.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn mm(length: Length) -> Option<f64> {
    finite(length.value())
}

fn um(length: Length) -> Option<f64> {
    finite(length.in_um())
}

impl FeatureBody {
    /// Of a feature of the judge.
    pub(crate) fn of(feature: &Feature) -> Self {
        let mut body = Self {
            op: feature.op,
            line: feature.line,
            kind: feature.kind_name(),
            tool: feature.tool,
            time_s: finite(feature.time.value()).unwrap_or(0.0),
            duration_s: finite(feature.duration.value()).unwrap_or(0.0),
            verdict: match feature.verdict {
                Verdict::Pass => "good",
                Verdict::Fail { .. } => "failed",
                Verdict::NotJudged { .. } => "not_judged",
            },
            reason: feature.verdict.reason().map(str::to_owned),
            position: feature
                .position()
                .map(|place| place.map(Length::value))
                .filter(|place| place.iter().all(|value| value.is_finite())),
            ..Self::default()
        };
        match &feature.kind {
            FeatureKind::Hole(hole) => {
                body.depth_mm = mm(hole.depth);
                body.depth_error_um = um(hole.depth_error);
                body.position_error_um = um(hole.position_error);
                body.diameter_mm = mm(hole.diameter);
            }
            FeatureKind::Thread(thread) => {
                body.depth_mm = mm(thread.depth);
                body.depth_error_um = um(thread.depth_error);
                body.position_error_um = um(thread.position_error);
                body.size = Some(thread.size.clone());
                body.lead_mm_per_rev = finite(thread.lead.value());
                body.sync_error_max_um = um(thread.sync_error_max);
                body.sync_error_depth_mm = mm(thread.sync_error_depth);
                body.sync_error_rms_um = um(thread.sync_error_rms);
                body.class = Some(thread.class_name());
                body.class_asked = Some(thread.class_asked.name());
                body.margin_um = um(thread.margin);
                body.limiting_gauge = Some(thread.limiting_gauge.name());
                body.pitch_diameter_mm = mm(thread.pitch_diameter);
                body.spin_max_rpm = finite(thread.spin_max.in_rpm());
                body.torque_max_n_m = thread.torque_max.and_then(|torque| finite(torque.value()));
                body.is_recovered = Some(thread.recovered);
            }
            FeatureKind::Turned(thread) => {
                body.lead_mm_per_rev = finite(thread.lead.value());
                body.sync_error_max_um = um(thread.sync_error_max);
                body.spin_max_rpm = finite(thread.spin_max.in_rpm());
            }
            FeatureKind::Milled(milled) => {
                body.depth_mm = milled.depth.and_then(|most| mm(most.value));
                body.diameter_mm = mm(milled.diameter);
                body.spin_max_rpm = finite(milled.spin_max.in_rpm());
            }
            // verdict and reason say what was found; their measures stand in the report
            FeatureKind::Polygon(_) | FeatureKind::Cam(_) | FeatureKind::Gear(_) => {}
        }
        body
    }
}
