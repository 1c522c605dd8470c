# The paper's experiments: `paper_experiment --out FILE.html` writes one page and prints JSON.
rigcal_library(paper_parts SOURCES paper/noise_experiment.cc paper/noise_section.cc paper/page.cc paper/plots.cc
               DEPS rigcal_graph rigcal_formats)
rigcal_program(paper_experiment SOURCES paper/paper_experiment.cc DEPS paper_parts)
