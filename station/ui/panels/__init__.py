"""The dashboard's tabs, one module each; what they decide is in the models beside."""
