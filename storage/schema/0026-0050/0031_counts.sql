-- What would be walked through in full at each question, and grows with the years.

CREATE TABLE summary_delivered (             -- how many alerts each receiver has
  url TEXT NOT NULL PRIMARY KEY,
  delivered INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO summary_delivered SELECT url, count(*) FROM alert_delivered GROUP BY url;
CREATE TRIGGER alert_delivered_counts AFTER INSERT ON alert_delivered
BEGIN
  INSERT INTO summary_delivered VALUES (new.url, 1) ON CONFLICT (url) DO UPDATE SET delivered = delivered + 1;
END;

-- Whether a sensor ever told another part: its least and its greatest.
CREATE INDEX sensor_part_serial ON sensor_part (robot_id, sensor_id, serial);
CREATE INDEX sensor_part_firmware ON sensor_part (robot_id, sensor_id, firmware);
