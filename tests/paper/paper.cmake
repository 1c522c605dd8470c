# The paper's experiments: `paper_experiment --out FOLDER` writes one page and prints JSON.
rigcal_library(paper_parts
  SOURCES paper/noise_experiment.cc paper/noise_section.cc paper/page.cc paper/plots.cc paper/visit.cc paper/joint_errors.cc
          paper/paths.cc paper/global_experiment.cc paper/noisy_sensors.cc paper/global_section.cc paper/chain_experiment.cc paper/chain_section.cc
          paper/method_experiment.cc paper/method_section.cc paper/experiment_json.cc
  DEPS rigcal_graph rigcal_formats rigcal_calib rigcal_sim)
rigcal_program(paper_experiment SOURCES paper/paper_experiment.cc DEPS paper_parts)
rigcal_test(paper_test SOURCES paper/paper_test.cc DEPS paper_parts)
