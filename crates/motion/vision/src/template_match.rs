//! Acceptance of the template that a tracked object matches.

/// At most one fully visible frame in this number may be without a matching template.
const FRAMES_PER_MISMATCH: u32 = 10;

/// The template that a track has matched so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct TemplateMatch {
    pub(crate) accepted: Option<usize>,
    /// The template that currently matches, and (in `candidate_frames`) the number of frames in a row in which it has
    /// matched.
    candidate: Option<usize>,
    candidate_frames: u32,
    frames_fully_visible: u32,
    frames_unmatched: u32,
}

impl TemplateMatch {
    /// Accepts a template that matches in some frames in a row, if nearly all fully visible frames have matched a
    /// template: a moving high, narrow object covers for a while the same floor as a lower, longer one.
    pub(crate) fn update(&mut self, matched: Option<usize>, template_frames: u32) {
        let is_same = matched == self.candidate;
        self.candidate_frames = if is_same { self.candidate_frames.saturating_add(1) } else { 1 };
        self.candidate = matched;
        self.frames_fully_visible = self.frames_fully_visible.saturating_add(1);
        self.frames_unmatched += u32::from(matched.is_none());
        let is_accepted = self.candidate_frames >= template_frames
            && self.frames_unmatched <= self.frames_fully_visible / FRAMES_PER_MISMATCH;
        self.accepted = matched.filter(|_| is_accepted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_is_accepted_after_some_frames_in_a_row_and_seldom_missed_before() {
        let mut seen = TemplateMatch::default();
        seen.update(Some(1), 3);
        seen.update(Some(2), 3);
        seen.update(Some(2), 3);
        assert_eq!(seen.accepted, None);
        seen.update(Some(2), 3);
        assert_eq!(seen.accepted, Some(2));
        // One mismatch of five frames is too many; of ten it is not.
        seen.update(None, 3);
        for frame in 6..10 {
            seen.update(Some(2), 3);
            assert_eq!(seen.accepted, None, "frame {frame}");
        }
        seen.update(Some(2), 3);
        assert_eq!(seen.accepted, Some(2));
    }
}
