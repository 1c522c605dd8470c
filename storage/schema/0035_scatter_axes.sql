-- Along which axes sensors scatter from visit to visit: what is shown along each over what axes that are alike would show. Zeros: not
-- told, of rows of before; the robot's next revision replaces them.

ALTER TABLE summary_scatter ADD COLUMN translation_ratio_x REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN translation_ratio_y REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN translation_ratio_z REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_ratio_x REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_ratio_y REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_ratio_z REAL NOT NULL DEFAULT 0;
