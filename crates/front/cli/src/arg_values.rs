//! Values of arguments: numbers, configurations, lengths of time.

/// Numbers with commas or spaces between them.
#[derive(Debug, Clone)]
pub(crate) struct Numbers(pub(crate) Vec<f64>);

impl std::str::FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |(i, word): (usize, &str)| {
            let value = word.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| format!("value {} is \"{}\", no finite number: write 0.5,-1.2,0", i + 1, word.trim()))
        };
        let has_commas = text.contains(',');
        let words: Vec<&str> = if has_commas { text.split(',').collect() } else { text.split_whitespace().collect() };
        words.into_iter().enumerate().map(number).collect::<Result<_, _>>().map(Self)
    }
}

/// Largest coordinate, m: beyond it, double precision has no micrometres.
const FARTHEST_M: f64 = 1e6;
/// Largest angle, rad: some turns.
const LARGEST_ANGLE_RAD: f64 = 100.0;

fn within(values: &[f64], most: f64, unit: &str) -> Result<(), String> {
    let beyond = values.iter().find(|v| v.abs() > most);
    beyond.map_or(Ok(()), |v| Err(format!("{v:e} is beyond {most} {unit}: is it in another unit?")))
}

/// A pose: x, y, z, roll, pitch, yaw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseNumbers(pub(crate) [f64; 6]);

impl std::str::FromStr for PoseNumbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Numbers(values) = text.parse()?;
        let count = values.len();
        let six: [f64; 6] =
            values.try_into().map_err(|_| format!("has {count} numbers: write x,y,z,roll,pitch,yaw"))?;
        within(&six[..3], FARTHEST_M, "metres")?;
        within(&six[3..], LARGEST_ANGLE_RAD, "radians")?;
        Ok(Self(six))
    }
}

/// A point of a link.
#[derive(Debug, Clone)]
pub(crate) struct LinkPoint {
    pub(crate) link: String,
    pub(crate) point: [f64; 3],
}

impl std::str::FromStr for LinkPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let hint = "write LINK,x,y,z, as link_3,0.1,0,0.05";
        // A name may contain commas.
        let mut words = text.rsplitn(4, ',');
        let (z, y, x, link) = (words.next(), words.next(), words.next(), words.next());
        let (Some(x), Some(y), Some(z), Some(link)) = (x, y, z, link) else {
            return Err(format!("needs a link and three numbers: {hint}"));
        };
        let Numbers(values) = format!("{x},{y},{z}").parse().map_err(|e| format!("{e}\n  {hint}"))?;
        let point: [f64; 3] = values.try_into().map_err(|_| hint.to_owned())?;
        within(&point, FARTHEST_M, "metres")?;
        Ok(Self { link: link.trim().to_owned(), point })
    }
}

/// An axis, and the angle by which it may turn, in the cell file's unit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KeptAxisArg {
    pub(crate) axis: [f64; 3],
    pub(crate) angle: f64,
}

impl std::str::FromStr for KeptAxisArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let hint = "write AXIS=ANGLE, as z=5 or 0,0.7,0.7=5";
        let (axis, angle) = text.split_once('=').ok_or_else(|| format!("has no angle: {hint}"))?;
        let axis = match axis.trim() {
            "x" => [1.0, 0.0, 0.0],
            "y" => [0.0, 1.0, 0.0],
            "z" => [0.0, 0.0, 1.0],
            numbers => {
                let Numbers(values) = numbers.parse().map_err(|e| format!("{e}\n  {hint}"))?;
                values.try_into().map_err(|_| hint.to_owned())?
            }
        };
        let angle = angle.trim().parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite());
        Ok(Self { axis, angle: angle.ok_or_else(|| format!("the angle is not above 0: {hint}"))? })
    }
}

/// A configuration: joint values, or the name of a state.
#[derive(Debug, Clone)]
pub(crate) enum Configuration {
    Values(Vec<f64>),
    Named(String),
}

impl std::str::FromStr for Configuration {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_word = |text: &str| text.parse::<f64>().is_err() && !text.contains([',', ' ']);
        if is_word(text.trim()) {
            return Ok(Self::Named(text.trim().to_owned()));
        }
        text.parse().map(|Numbers(values)| Self::Values(values))
    }
}

/// A distance in metres.
pub(crate) fn margin(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|v| *v >= 0.0 && v.is_finite());
    value.ok_or_else(|| "write a number of metres, 0 or more, as 0.1".into())
}

/// A duration in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|v| *v >= 1e-5 && *v <= 1e6);
    value.ok_or_else(|| "write a number of seconds from 0.00001 to 1000000, as 2.5".into())
}

/// A duration in milliseconds.
pub(crate) fn milliseconds(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|v| *v > 0.0 && *v <= 1e9);
    value.ok_or_else(|| "write a number of milliseconds above 0, as 5".into())
}
