//! The work-piece before a camera.

use elbowroom_vision::Visibility;

use crate::VirtualRobot;
use crate::holding::parts;

impl VirtualRobot<'_> {
    /// Keeps the work-piece in view of a camera from now on, as far as another arm can take it: an arm that will hide more
    /// than [`hidden_share`](crate::CooperationSettings::hidden_share) hands it over before. The motion never stops for it.
    pub fn keep_in_view(&mut self, visibility: &Visibility) {
        for (holding, forecast) in self.holdings.iter_mut().zip(&mut self.forecasts) {
            holding.visibility = Some(visibility.clone());
            forecast.restart();
        }
    }

    /// The share of the part of the work-piece in view of the camera that the arms hide now, all together, 0 to 1. `None`
    /// without a camera, and if the work-piece is out of the picture or shows no face to the camera.
    pub fn hidden_share(&mut self) -> Option<f64> {
        let part_in_world = self.part_in_world();
        let Self { scene, state, members, holdings, carried, .. } = self;
        let visibility = holdings[carried.holder].visibility.as_mut()?;
        let arms = members.iter().flat_map(|m| parts(scene, state, m.robot));
        visibility.hidden_share(&part_in_world, arms)
    }
}
