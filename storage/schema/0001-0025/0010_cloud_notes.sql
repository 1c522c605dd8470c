-- What is odd about the points of a cloud in which a target was looked for. Empty: nothing, or looked at before this.

ALTER TABLE detected_cloud ADD COLUMN note TEXT NOT NULL DEFAULT '';
