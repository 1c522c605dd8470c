# Boards to print. OpenCV's drawing of a charuco is an oracle; PDF and SVG are drawn by poppler and librsvg.
rigcal_test(print_test SOURCES unit/client/print/pattern_test.cc DEPS rigcal_print)
rigcal_test(print_raster_test COMPUTES SOURCES unit/client/print/raster_test.cc DEPS rigcal_print rigcal_detect rigcal_storage)
