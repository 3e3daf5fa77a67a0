"""Data sets by name: make, load, verify, draw, push, and draw prompts from.

names         the grammar of the names, and where a data set lies
columns       what a frame holds, and the content fingerprint
writing       LeRobot's files, written on all cores
manifest      what a data set says about itself
loading       make on demand, and load
drawing       a copy with a drawing of each decision
certificates  how sure the exact reader is of each episode of the second tier
verification  everything a data set must satisfy
  stored_data     a data set as its files hold it
  episode_checks  each episode is what the user of its session does
cards         a card for each data set
hub_upload    to the Hugging Face hub
publishing    fingerprints and cards of the published data sets
commands      `kitchen-prefs datasets`

demonstration_store  the demonstrations of a data set in memory
prompt_reading       one episode as the prompt of an evaluation
prompt_step          the prompts of a policy's training, a processor step of LeRobot's
"""

from kitchen_prefs.datasets.loading import load_dataset, make_dataset
from kitchen_prefs.datasets.names import dataset_names, dataset_root

__all__ = ["dataset_names", "dataset_root", "load_dataset", "make_dataset"]
