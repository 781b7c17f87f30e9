"""A bank of scenes as people of several trades would send them, in the default mode: does each get an answer?"""
