<?xml version="1.0" encoding="UTF-8"?><project xmlns="http://grogra.de/registry" graph="graph.xml">
<import plugin="de.grogra.imp3d" version="1.5"/>
<registry>
<ref name="project"><ref name="objects"><ref name="images"><de.grogra.pf.ui.registry.FileObjectItem mimeType="image/png" name="leaf" systemId="pfs:images/leaf.png" type="de.grogra.imp.objects.FixedImageAdapter"/></ref></ref></ref>
<ref name="workbench"><ref name="state">
<de.grogra.pf.ui.registry.Layout name="layout"><de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.6981317007977318] transformation=(1.0 0.0 -0.0 0.0 0.0 0.40273861426601687 0.9153150324227656 -0.7322520259382123 0.0 -0.9153150324227656 0.40273861426601687 -5.784791004911879 0.0 0.0 0.0 1.0))"/></de.grogra.pf.ui.registry.Layout>
</ref></ref>
</registry></project>
