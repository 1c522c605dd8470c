-- Along which axes sensors scatter from visit to visit: what is shown along each over what axes that are alike would show. Zeros: not
-- told, of rows of before; the robot's next revision replaces them.

ALTER TABLE summary_scatter ADD COLUMN translation_x_ratio REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN translation_y_ratio REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN translation_z_ratio REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_x_ratio REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_y_ratio REAL NOT NULL DEFAULT 0;
ALTER TABLE summary_scatter ADD COLUMN rotation_z_ratio REAL NOT NULL DEFAULT 0;
